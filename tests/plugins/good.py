"""A well-behaved plugin: points of a linear congruential generator (Numerical Recipes' constants),
which the test computes for itself. Asks in generations and recommends the best point at the end."""
import json
import sys


def send(message):
    print(json.dumps(message), flush=True)


def receive():
    return json.loads(sys.stdin.readline())


def minimize(task):
    variables = task["problem"]["variables"]
    state = task["seed"] % 2**32
    best = None
    points = [[v["start"] for v in variables]]
    while True:
        send({"type": "ask", "generation": True, "points": points})
        answer = receive()
        for point, score in zip(points, answer["scores"]):
            if score["status"] == "ok" and (best is None or score["objectives"][0] < best[0]):
                best = (score["objectives"][0], point)
        if answer["stopped"]:
            break
        points = []
        for _ in range(task["options"]["batch"]):
            point = []
            for v in variables:
                state = (1664525 * state + 1013904223) % 2**32
                point.append(v["lower"] + state / 2**32 * (v["upper"] - v["lower"]))
            points.append(point)
    if best is not None:
        send({"type": "recommend", "x": best[1]})
    send({"type": "done"})


assert receive() == {"type": "hello", "protocol": 1}
send({
    "type": "description", "protocol": 1, "name": "lcg",
    "summary": "Points of a linear congruential generator",
    "source": "Press et al. 1992, Numerical Recipes",
    "capabilities": ["bounds", "batch", "stochastic", "generations", "sampling"],
    "options": [
        {"name": "batch", "description": "points a generation", "default": 5, "lower": 1,
         "upper": 1000},
        {"name": "share", "description": "unused", "default": 0.5, "lower": 0, "upper": 1},
        {"name": "kind", "description": "unused", "default": "a", "choices": ["a", "b"]},
        {"name": "flag", "description": "unused", "default": False},
    ],
})
request = receive()
if request["type"] == "minimize":
    minimize(request)
