"""Differential evolution (Storn and Price 1997, Differential evolution - a simple and efficient
heuristic for global optimization over continuous spaces) in the implementation of SciPy, as a
plugin for armwright:

    armwright optimize sphere --optimizer 'exec:/usr/bin/python3 scipy_de.py'

The plugin needs SciPy 1.9 or later (Debian: python3-scipy). It asks for a whole generation at a
time. SciPy works on the logarithm of logarithmic variables. The start is the first member of the
population.
"""
import json
import os
import sys

PROTOCOL = 1

DESCRIPTION = {
    "type": "description",
    "protocol": PROTOCOL,
    "name": "scipy-de",
    "summary": "Differential evolution as SciPy implements it, a generation at a time",
    "source": "Storn and Price 1997, Differential evolution - a simple and efficient heuristic "
              "for global optimization over continuous spaces",
    "capabilities": ["bounds", "batch", "stochastic"],
    "options": [
        {"name": "population", "description": "members of the population for each variable",
         "default": 15, "lower": 1, "upper": 1000},
        {"name": "strategy", "description": "how a trial vector is made",
         "default": "best1bin",
         "choices": ["best1bin", "best1exp", "rand1bin", "rand1exp", "best2bin", "rand2bin",
                     "randtobest1bin", "currenttobest1bin"]},
        {"name": "crossover", "description": "probability that a coordinate is taken over",
         "default": 0.7, "lower": 0, "upper": 1},
        {"name": "mutation_lower", "description": "differential weight, drawn anew for every "
         "generation from here", "default": 0.5, "lower": 0, "upper": 2},
        {"name": "mutation_upper", "description": "to here", "default": 1.0, "lower": 0,
         "upper": 2},
        {"name": "violation_weight", "description": "of violated constraints, added to the first "
         "objective", "default": 1e6, "lower": 0, "upper": 1e15},
    ],
}


class Stopped(Exception):
    """Raised when the host evaluates no more points."""


def send(message):
    # Standard output is only for the protocol. Without the flush the host would wait forever.
    try:
        sys.stdout.write(json.dumps(message) + "\n")
        sys.stdout.flush()
    except BrokenPipeError:
        os._exit(0)  # the host has ended


def receive():
    line = sys.stdin.readline()
    if not line:
        sys.exit(0)  # the host has ended
    return json.loads(line)


def minimize(task):
    import numpy as np  # imported here so that the description is sent without delay
    from scipy.optimize import differential_evolution

    options = task["options"]
    variables = task["problem"]["variables"]
    is_log = np.array([v["scale"] == "logarithmic" for v in variables])
    sign = np.array([-1.0 if v["lower"] < 0 else 1.0 for v in variables])
    lower = np.array([v["lower"] for v in variables])
    upper = np.array([v["upper"] for v in variables])

    def to_coordinates(x):
        return np.where(is_log, np.log(np.where(is_log, np.abs(x), 1.0)), x)

    def to_point(coordinates):
        magnitude = np.exp(np.where(is_log, coordinates, 0.0))
        return np.clip(np.where(is_log, sign * magnitude, coordinates), lower, upper)

    ends = np.sort([to_coordinates(lower), to_coordinates(upper)], axis=0)

    def calc_merit(score):
        violation = sum(max(0.0, g) for g in score["constraints"])
        # Without weights, only the first objective counts.
        weights = task["problem"]["objective_weights"] or [1.0]
        value = sum(weight * one for weight, one in zip(weights, score["objectives"]))
        return value + options["violation_weight"] * violation

    def calc_merits(columns):  # one column per point
        points = [to_point(column).tolist() for column in np.atleast_2d(columns.T)]
        send({"type": "ask", "points": points})
        answer = receive()
        if answer["stopped"]:
            raise Stopped
        return np.array([calc_merit(score) for score in answer["scores"]])

    if options["mutation_lower"] > options["mutation_upper"]:
        sys.exit("mutation_lower must not be above mutation_upper")
    start = to_coordinates(np.array([v["start"] for v in variables]))
    try:
        differential_evolution(
            calc_merits, list(zip(*ends)), x0=start, vectorized=True, updating="deferred",
            strategy=options["strategy"], popsize=options["population"],
            recombination=options["crossover"],
            mutation=(options["mutation_lower"], options["mutation_upper"]),
            seed=np.random.default_rng(task["seed"]), polish=False, init="latinhypercube",
            maxiter=10**9, tol=0, atol=0)
    except Stopped:
        pass
    send({"type": "done"})


def main():
    hello = receive()
    if hello.get("protocol") != PROTOCOL:
        print(f"speaks protocol {PROTOCOL}, armwright speaks {hello.get('protocol')}",
              file=sys.stderr)
    send(DESCRIPTION)
    task = receive()
    if task["type"] == "minimize":
        minimize(task)


main()
