"""Evaluates the start until the budget ends, and then recommends the origin. With the option `end` = "early" it ends after one evaluation and
says why; with "at_once" it evaluates nothing; with "bad" its last recommendation is too short."""
import json
import sys


def send(message):
    print(json.dumps(message), flush=True)


def receive():
    return json.loads(sys.stdin.readline())


def minimize(task):
    end = task["options"]["end"]
    start = [v["start"] for v in task["problem"]["variables"]]
    if end == "at_once":
        return {"type": "done", "reason": "no licence"}
    while True:
        send({"type": "ask", "points": [start]})
        if receive()["stopped"]:
            break
        if end == "early":
            return {"type": "done", "reason": "all is seen"}
    send({"type": "recommend", "x": [0.0] * (len(start) - (1 if end == "bad" else 0))})
    return {"type": "done"}


assert receive() == {"type": "hello", "protocol": 1}
send({
    "type": "description", "protocol": 1, "name": "late", "summary": "Recommends after the end of the budget", "source": "the tests",
    "capabilities": ["bounds"],
    "options": [{"name": "end", "description": "how it ends", "default": "late", "choices": ["late", "early", "at_once", "bad"]}],
})
request = receive()
if request["type"] == "minimize":
    send(minimize(request))
