"""Evaluates points of a linear congruential generator, two at a time. After ten of them it waits for
as long as there is a file of the name in PATIENT_GATE, so that a test can catch it in the midst."""
import json
import os
import sys
import time


def send(message):
    print(json.dumps(message), flush=True)


def receive():
    return json.loads(sys.stdin.readline())


def minimize(task):
    variables = task["problem"]["variables"]
    gate = os.environ.get("PATIENT_GATE", "")
    state = task["seed"] % 2**32
    evaluated = 0
    while True:
        points = []
        for _ in range(2):
            point = []
            for v in variables:
                state = (1664525 * state + 1013904223) % 2**32
                point.append(v["lower"] + state / 2**32 * (v["upper"] - v["lower"]))
            points.append(point)
        send({"type": "ask", "points": points})
        if receive()["stopped"]:
            break
        evaluated += len(points)
        while evaluated == 10 and gate and os.path.exists(gate):
            time.sleep(0.02)
    send({"type": "done"})


assert receive() == {"type": "hello", "protocol": 1}
send({
    "type": "description", "protocol": 1, "name": "patient",
    "summary": "Points of a linear congruential generator, with a pause",
    "source": "Press et al. 1992, Numerical Recipes",
    "capabilities": ["bounds", "batch", "stochastic", "sampling"],
    "options": [],
})
request = receive()
if request["type"] == "minimize":
    minimize(request)
