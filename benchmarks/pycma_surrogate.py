"""pycma with and without its surrogate, from the starts of cmaes_benchmark: the stored numbers beside which docs/cmaes.md puts ours.

    build/release/bin/cmaes_benchmark --starts > starts.json
    /usr/bin/python3 benchmarks/pycma_surrogate.py starts.json > results/surrogate/pycma.csv

Needs numpy and the package cma (pycma). Prints one row per start: the evaluations to the target without a surrogate and with fmin_lq_surr2, empty
where a run did not reach it. All that is not named here is pycma's default; the ends that come before the target or the budget are off.
"""
import json
import sys
import warnings

import cma

PATIENT = {"tolfun": 0, "tolfunhist": 0, "tolx": 1e-15, "tolflatfitness": 1000, "tolstagnation": 100000, "verbose": -9, "verb_log": 0}


def ellipsoid(x):
    return sum(1e6 ** (i / (len(x) - 1)) * xi * xi for i, xi in enumerate(x))


def rosenbrock(x):
    return sum(100 * (b - a * a) ** 2 + (1 - a) ** 2 for a, b in zip(x, x[1:]))


FUNCTIONS = {"sphere": lambda x: sum(xi * xi for xi in x), "ellipsoid": ellipsoid, "rosenbrock": rosenbrock}


class Reached(Exception):
    """Ends a run at its target."""


def count(run, search):
    evaluations = 0

    def calc(x):
        nonlocal evaluations
        evaluations += 1
        value = FUNCTIONS[run["function"]]([float(xi) for xi in x])
        if value < run["target"]:
            raise Reached
        return value

    try:
        search(calc, run["start"], run["sigma"], {"seed": run["seed"], "maxfevals": run["budget"], **PATIENT})
    except Reached:
        return evaluations
    return ""


warnings.filterwarnings("ignore")
with open(sys.argv[1], encoding="utf-8") as file:
    runs = json.load(file)
print(f"# pycma {cma.__version__.split()[0]}\nfunction,n,seed,plain,surrogate", flush=True)
for run in runs:
    plain = count(run, cma.fmin2)
    print(f'{run["function"]},{len(run["start"])},{run["seed"]},{plain},{count(run, cma.fmin_lq_surr2)}', flush=True)
