"""The problem of a user: f = x^2 + n^2, with faults that its arguments name.

A fault of an answer appears where x > 4, so that all other cases show that the run goes on.
"""
import json
import math
import os
import signal
import subprocess
import sys
import time

fault = sys.argv[1] if len(sys.argv) > 1 else ""


def say(text):
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def send(message):
    say(json.dumps(message))


description = {
    "type": "problem", "protocol": 1, "name": "faulty", "summary": "x squared and n squared",
    "variables": [{"name": "x", "lower": -5, "upper": 5, "start": 3, "unit": "mm"},
                  {"name": "n", "type": "integer", "lower": -3, "upper": 8, "start": 2},
                  {"name": "word", "type": "category", "choices": ["plain", "dear"]}],
    "objectives": [{"name": "f", "unit": "N"}]}
variable = description["variables"]
if fault == "protocol":
    description["protocol"] = 7
elif fault == "unknown-type":
    variable[1]["type"] = "complex"
elif fault == "crossed":
    variable[0]["lower"] = 6
elif fault == "start-outside":
    variable[0]["start"] = 5.5
elif fault == "half-integer":
    variable[1]["start"] = 2.5
elif fault == "zero-logarithmic":
    variable[0]["scale"] = "logarithmic"
elif fault == "duplicate":
    variable[1]["name"] = "x"
elif fault == "one-word":
    variable[2]["choices"] = ["plain"]
elif fault == "unnamed":
    del description["objectives"][0]["name"]
elif fault == "no-objectives":
    description["objectives"] = []
elif fault == "no-variables":
    del description["variables"]
elif fault == "no-list":
    description["variables"] = {"x": 1}
elif fault == "huge-count":
    description["cases"] = {"training": 1e300}
elif fault == "greeting":
    say("Loading the model...")
elif fault == "early-exit":
    sys.stderr.write("no licence\n")
    sys.exit(4)
elif fault == "other-message":
    description["type"] = "description"
elif fault == "changes":  # from the second start on
    if os.path.exists(sys.argv[2]):
        variable[0]["upper"] = 7
    open(sys.argv[2], "w").close()
elif fault == "sum":
    description["residuals"] = True
elif fault == "seeds":
    description["cases"] = {"training": 0}
elif fault == "slow-squares":
    description["residuals"] = True
elif fault == "rich":
    description.update({
        "objectives": [{"name": "gain", "unit": "dB", "direction": "maximize", "weight": 2,
                        "penalty": -100, "bound": 90}, {"name": "cost", "penalty": 100}],
        "constraints": [{"name": "heat", "unit": "W", "limit": 5}],
        "metrics": [{"name": "mass", "unit": "kg"}],
        "cases": {"training": 4, "validation": 3, "test": 2}, "records": True})


def compute(x, n, word):
    if x > 4:
        if fault == "exit":
            sys.exit(3)
        if fault == "last-words":
            sys.stderr.write(f"process {os.getpid()}: no mesh\n")
            sys.exit(3)
        if fault == "crash":
            os.kill(os.getpid(), signal.SIGSEGV)
        if fault == "dies":
            with open(sys.argv[2], "a") as file:
                file.write(f"{os.getpid()}\n")
            os.kill(os.getpid(), signal.SIGTERM)
        if fault == "late":
            time.sleep(600)
        if fault == "nan":
            return math.nan
        if fault == "infinite":
            return -math.inf
        if fault == "null":
            return None
        if fault == "refuses":
            return {"status": "diverged", "reason": "the beam broke"}
        if fault == "memory":
            global hoard
            hoard = bytearray(400 << 20)
            time.sleep(600)
        if fault == "child-memory":
            subprocess.Popen([sys.executable, "-c", "b = bytearray(400 << 20); import time; time.sleep(600)"])
            time.sleep(600)
        if fault == "closed":
            os.close(1)
            time.sleep(600)
        if fault == "children":
            child = subprocess.Popen(["sleep", "600"])
            with open(sys.argv[2], "w") as file:
                file.write(str(child.pid))
            os._exit(5)
        if fault == "long-line":
            say("[" + "1," * (50 << 20))
        if fault == "not-json":
            say("step 1: \x1b[31mfine\x1b[0m")
        if fault == "text":
            return "large"
        if fault == "wrong-length":
            return {"objectives": [1, 2]}
        if fault == "missing":
            return {"cost": 1}
        if fault == "status":
            return {"status": "tired"}
    if fault == "slow-squares":
        time.sleep(0.001)
        gate = os.environ.get("TEST_GATE")
        while gate and x > 1 and not os.path.exists(gate):  # like a case without end
            open(gate + ".reached", "w").close()
            time.sleep(0.01)
        residuals = [x - 1.5, 0.5 * n, 1.0 if word == "dear" else 0.25, math.sin(3 * x)]
        return {"objectives": [sum(r * r for r in residuals)], "residuals": residuals}
    if fault == "sum":
        return {"objectives": [x * x + 1], "residuals": [x]}
    return x * x + n * n + (1 if word == "dear" else 0)


def compute_richly(point, number):
    x, n, word = point
    if x > 4 and number == 1:
        return {"status": "failed", "reason": "case 1 is too hard"}
    return {"objectives": [number - x * x, n + number], "constraints": [abs(x) + number],
            "metrics": [10 * number]}


for line in sys.stdin:
    message = json.loads(line)
    kind = message["type"]
    if kind == "hello":
        send(description)
        if fault == "deaf":
            time.sleep(600)
    elif kind == "quit":
        break
    elif kind == "record":
        send({"type": "record", "id": message["id"],
              "abscissa": {"name": "time", "unit": "s", "values": [0, 1, 2]},
              "series": [{"name": "speed", "unit": "rad/s", "values": [0, 0.5, message["points"][0][0]]}],
              "files": [{"name": "note.txt", "text": "done"}, {"name": "dot.png", "base64": "iVBORw0="}]})
    elif fault == "rich":
        send({"type": "answers", "id": message["id"],
              "answers": [compute_richly(*pair) for pair in zip(message["points"], message["cases"])]})
    else:
        answers = [compute(*point) for point in message["points"]]
        if any(point[0] > 4 for point in message["points"]):
            if fault == "too-many":
                answers.append(1)
            if fault == "too-few":
                answers.pop()
            if fault == "too-few-together" and len(answers) > 1:
                answers.pop()
            if fault == "other-question":
                message["id"] += 1
        if fault == "seeds":
            answers = message["seeds"]
        send({"type": "answers", "id": message["id"], "answers": answers})
