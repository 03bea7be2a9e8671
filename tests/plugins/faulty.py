"""A plugin that misbehaves in the way its first argument names."""
import json
import os
import signal
import subprocess
import sys
import time

fault = sys.argv[1]


def say(text):
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def send(message):
    say(json.dumps(message))


def receive():
    return json.loads(sys.stdin.readline())


def ask(points):
    send({"type": "ask", "points": points})
    return receive()


receive()
if fault == "late":  # from the second start on
    if os.path.exists(sys.argv[2]):
        time.sleep(600)
    open(sys.argv[2], "w").close()
description = {"type": "description", "protocol": 1, "name": "faulty", "summary": "Misbehaves",
               "source": "", "capabilities": ["bounds"], "options": []}
if fault == "protocol":
    description["protocol"] = 7
elif fault == "capability":
    description["capabilities"] = ["bonds"]
elif fault == "shipped-name":
    description["name"] = "ga"
elif fault == "bad-name":
    description["name"] = "../x"
elif fault == "own-option":
    description["options"] = [{"name": "log", "default": "x"}]
elif fault == "option-range":
    description["options"] = [{"name": "k", "default": 3, "lower": 5, "upper": 9}]
elif fault == "no-range":
    description["options"] = [{"name": "k", "default": 3}]
elif fault == "option":
    description["options"] = [json.loads(sys.argv[2])]
elif fault == "greeting":
    say("Hello, world")
elif fault == "deep-greeting":
    say('{"type": "description", "protocol": ' + 200000 * "[" + 200000 * "]" + "}")
elif fault == "early-exit":
    sys.stderr.write("no licence\n")
    sys.exit(4)
elif fault == "two-faces":
    description["summary"] = str(os.getpid())
send(description)
task = receive()
if task["type"] == "quit":
    sys.exit(0)
start = [v["start"] for v in task["problem"]["variables"]]
ask([start])

if fault == "silent":
    time.sleep(600)
elif fault == "drip":
    for _ in range(200):
        sys.stdout.write(" ")
        sys.stdout.flush()
        time.sleep(0.03)
    sys.exit(3)
elif fault == "exit":
    sys.exit(3)
elif fault == "throw":
    raise RuntimeError("out of ideas")
elif fault == "loop":
    while True:
        pass
elif fault == "print":
    while True:
        sys.stderr.write("I have nothing to say and I say it. ")
elif fault == "exit-after-done":
    send({"type": "done"})
    sys.exit(3)
elif fault == "no-done":
    sys.exit(0)
elif fault == "crash":
    os.kill(os.getpid(), signal.SIGSEGV)
elif fault == "closed":
    os.close(1)
    time.sleep(600)
elif fault == "memory":
    hoard = []
    while True:
        hoard.append(b"x" * 2**20)
        time.sleep(0.001)
elif fault == "not-json":
    say("iteration 1: \x1b[31mfine\x1b[0m " + 200 * "y")
elif fault == "no-type":
    say("[1, 2]")
elif fault == "unknown-type":
    send({"type": "tell"})
elif fault == "deep":
    say('{"type": "recommend", "x": ' + 200000 * "[" + 200000 * "]" + "}")
elif fault == "length":
    send({"type": "ask", "points": [start, start[1:]]})
elif fault == "nan":
    send({"type": "ask", "points": [[float("nan")] + start[1:]]})
elif fault == "null":
    send({"type": "ask", "points": [[None] + start[1:]]})
elif fault == "huge-number":
    say('{"type": "ask", "points": [[1e999]]}')
elif fault == "outside":
    send({"type": "ask", "points": [[1e6] + start[1:]]})
elif fault == "no-points":
    send({"type": "ask", "points": []})
elif fault == "recommend-length":
    send({"type": "recommend", "x": [1]})
elif fault == "chatter":
    for _ in range(200000):
        send({"type": "recommend", "x": start})
elif fault == "long-line":
    for _ in range(70):
        sys.stdout.write(2**20 * "1")
    sys.stdout.flush()
elif fault == "deaf":
    batch = json.dumps({"type": "ask", "points": 20000 * [start]})
    while True:
        say(batch)
elif fault == "children":
    child = subprocess.Popen(["sleep", "600"])
    with open(sys.argv[2], "w") as file:
        file.write(str(child.pid))
    sys.exit(5)
elif fault == "never-stops":
    while True:
        ask([start])
elif fault == "sleeps-when-stopped":
    while not ask([start])["stopped"]:
        pass
    time.sleep(600)
elif fault == "fails-when-stopped":
    while not ask([start])["stopped"]:
        pass
    say("not JSON")
    sys.exit(9)
elif fault == "notes":
    sys.stderr.write("a note\n")
    send({"type": "done"})
time.sleep(2)
