"""Treats integers and categories itself. It says on its standard error what it is told of the variables, and asks for the start."""
import json
import sys


def send(message):
    print(json.dumps(message), flush=True)


def receive():
    return json.loads(sys.stdin.readline())


receive()
send({
    "type": "description", "protocol": 1, "name": "typed", "summary": "Says what it sees of the variables", "source": "a test",
    "capabilities": sys.argv[1:], "options": [],
})
task = receive()
if task["type"] == "minimize":
    variables = task["problem"]["variables"]
    for v in variables:
        print(v["name"], v.get("type"), v["lower"], v["upper"], v.get("choices"), file=sys.stderr)
    send({"type": "ask", "generation": False, "points": [[v["start"] for v in variables]]})
    receive()
    send({"type": "done"})
