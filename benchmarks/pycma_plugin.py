"""pycma as an optimizer of armwright, and its stored run: the other half of tests/study/compare/cmaes_bbob_test.cpp.

    armwright compare benchmarks/cmaes-bbob.toml --out results/cmaes-bbob
    python3 benchmarks/pycma_plugin.py results/cmaes-bbob > tests/data/bbob/pycma.json

The study runs this file as a plugin, from the root of the repository. It needs the package cma (pycma) and numpy. Start and bounds are those of the
problem. The initial step and all else that matters are pycma's defaults, except that the run ends at 5e-9 and not when progress is slow.
"""
import json
import pathlib
import sys
import warnings

TARGET = 1e-8
# Ends that would come before the target or before the budget.
PATIENT = {"tolfun": 0, "tolfunhist": 0, "tolx": 1e-13, "tolflatfitness": 1000, "tolstagnation": 100000, "verbose": -9, "verb_log": 0}
DESCRIPTION = {
    "type": "description", "protocol": 1, "name": "pycma", "summary": "pycma's CMAEvolutionStrategy with bounds",
    "source": "Hansen, Akimoto and Baudis, CMA-ES/pycma on GitHub", "capabilities": ["bounds", "stochastic", "generations"],
    "options": [{"name": "sigma", "description": "initial step, as a share of the box", "default": 0.05, "lower": 1e-6, "upper": 1.0}],
}


def send(message):
    print(json.dumps(message), flush=True)


def receive():
    line = sys.stdin.readline()
    return json.loads(line) if line else {"type": "quit"}


def minimize(task):
    warnings.filterwarnings("ignore")
    import cma

    variables = task["problem"]["variables"]
    lower, upper = ([v[key] for v in variables] for key in ("lower", "upper"))
    strategy = cma.CMAEvolutionStrategy(
        [v["start"] for v in variables], task["options"]["sigma"] * (upper[0] - lower[0]),
        {"bounds": [lower, upper], "seed": task["seed"] % 4294967295 + 1, **PATIENT})
    while not strategy.stop():
        points = strategy.ask()
        asked = [[min(max(float(x), low), high) for x, low, high in zip(point, lower, upper)] for point in points]
        send({"type": "ask", "points": asked, "generation": True})
        answer = receive()
        values = [score["objectives"][0] for score in answer.get("scores", [])]
        if answer.get("stopped", True) or min(values) < TARGET / 2:
            break
        strategy.tell(points, values)
    send({"type": "done", "reason": str(dict(strategy.stop()))})


def collect(study):
    """Returns per problem, in the order of the replicates, the value of the start and the evaluations to the target (None: not reached)."""
    problems = {}
    for file in sorted(pathlib.Path(study).glob("cells/*/pycma/*/cell.json")):
        cell = json.loads(file.read_text())
        hits = [cases for cases, value, _ in cell["trace"] if value is not None and value <= TARGET]
        problem = problems.setdefault(cell["problem"], {"start_values": [], "evaluations": []})
        problem["start_values"].append(cell["start_value"])
        problem["evaluations"].append(min(hits) if hits else None)
    import cma

    lines = [f'    "{name}": {json.dumps(problem)}' for name, problem in problems.items()]
    return '{\n  "pycma": "%s",\n  "problems": {\n%s\n  }\n}\n' % (cma.__version__, ",\n".join(lines))


if len(sys.argv) > 1:
    sys.stdout.write(collect(sys.argv[1]))
else:
    receive()
    send(DESCRIPTION)
    question = receive()
    if question["type"] == "minimize":
        minimize(question)
