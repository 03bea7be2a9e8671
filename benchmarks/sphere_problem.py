"""The sphere in 20 variables as the program of a problem, for overhead_benchmark.

    sphere_problem.py           answers questions, as docs/problem-protocol.md says
    sphere_problem.py bare N    exchanges N of the same messages, of 100 points each, with such a
                                program and prints how many seconds that takes
"""
import json
import random
import subprocess
import sys
import time

DIMENSION = 20


def answer(message):
    if message["type"] == "hello":
        return {"type": "problem", "protocol": 1, "name": "sphere20", "summary": "The sphere",
                "variables": [{"name": f"x_{i + 1}", "lower": -5, "upper": 5} for i in range(DIMENSION)],
                "objectives": [{"name": "f"}]}
    return {"type": "answers", "id": message["id"],
            "answers": [sum(x * x for x in point) for point in message["points"]]}


def serve():
    for line in sys.stdin:
        message = json.loads(line)
        if message["type"] == "quit":
            return
        sys.stdout.write(json.dumps(answer(message)) + "\n")
        sys.stdout.flush()


def exchange(batches):
    child = subprocess.Popen([sys.executable, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ask(message):
        child.stdin.write(json.dumps(message) + "\n")
        child.stdin.flush()
        return json.loads(child.stdout.readline())

    ask({"type": "hello", "protocol": 1})
    draws = random.Random(1)
    points = [[[draws.uniform(-5, 5) for _ in range(DIMENSION)] for _ in range(100)] for _ in range(10)]
    begin = time.perf_counter()
    for i in range(batches):
        ask({"type": "evaluate", "id": i + 1, "role": "training", "set": "train/1", "points": points[i % 10],
             "cases": 100 * [0]})
    print(time.perf_counter() - begin)
    child.stdin.close()
    child.wait()


if sys.argv[1:2] == ["bare"]:
    exchange(int(sys.argv[2]))
else:
    serve()
