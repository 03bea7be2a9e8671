#!/usr/bin/python3
"""Compares the cost of evaluations from Python with that of the program: the table of docs/python.md.

    PYTHONPATH=build/release/python /usr/bin/python3 benchmarks/python_benchmark.py [--evaluations N] [--repetitions R]

By turns, so that a machine that slows down slows down all, on the same threads:

    program    armwright optimize PROBLEM --optimizer random --schedule fixed:1 --budget N
    evaluate   problem.evaluate() of N points on one case, in one call
    optimize   armwright.optimize() of the same as the program
    class      the same search as a class in Python, in batches of 1000 points

Wall-clock time in seconds of each, the start of the program or of the interpreter left out (measured with a budget of 1), and medians of
the ratios to the program's within a repetition. The program and the runs write the same files: journal, tables, results.sqlite.
"""
import argparse
import os
import pathlib
import statistics
import subprocess
import tempfile
import time

import numpy as np

import armwright

PROGRAM = os.environ.get("ARMWRIGHT_BINARY", str(pathlib.Path(__file__).resolve().parents[1] / "build/release/bin/armwright"))
PROBLEMS = {"q1-complex": {"physics.engine": "articulated"}, "sphere": {}}


class RandomSearch(armwright.Optimizer):
    """Independent points, uniform on every variable's scale, as the program's own random search draws them."""

    capabilities = ("bounds", "batch", "stochastic", "sampling")

    def minimize(self, evaluator, seed):
        random = np.random.default_rng(seed)
        while not evaluator.stopped:
            evaluator.evaluate(evaluator.problem.from_unit(random.random((1000, len(evaluator.problem)))))


def measure_s(call):
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


def measure(name, settings, evaluations, jobs):
    problem = armwright.load_problem(name, set=settings)
    points = problem.from_unit(np.random.default_rng(1).random((evaluations, len(problem))))
    words = [f"--set={key}={value}" for key, value in settings.items()]
    with tempfile.TemporaryDirectory() as folder:
        def run_program(budget):
            subprocess.run([PROGRAM, "optimize", name, *words, *"--optimizer random --schedule fixed:1 --quiet".split(), "--budget", str(budget),
                            "--jobs", str(jobs), "--out", f"{folder}/program-{budget}"], check=True, capture_output=True)

        def run_here(kind, optimizer):
            return lambda budget: armwright.optimize(problem, optimizer, schedule="fixed:1", budget=budget, jobs=jobs,
                                                     out=f"{folder}/{kind}-{budget}", progress=False)

        times = {}
        for kind, call in (("program", run_program), ("optimize", run_here("optimize", "random")), ("class", run_here("class", RandomSearch))):
            start_s = measure_s(lambda: call(1))
            times[kind] = measure_s(lambda: call(evaluations)) - start_s
        times["evaluate"] = measure_s(lambda: problem.evaluate(points, cases=1, jobs=jobs))
        return times


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--evaluations", type=int, default=100_000)
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--jobs", type=int, default=2)
    asked = parser.parse_args()
    print(f"{asked.evaluations} evaluations, {asked.jobs} threads, medians of {asked.repetitions}\n")
    print("| problem | program | `problem.evaluate` | ratio | `optimize` | ratio | class | ratio |\n|---|---|---|---|---|---|---|---|")
    for name, settings in PROBLEMS.items():
        rounds = [measure(name, settings, asked.evaluations, asked.jobs) for _ in range(asked.repetitions)]
        cells = [name, f"{statistics.median(one['program'] for one in rounds):.2f} s"]
        for kind in ("evaluate", "optimize", "class"):
            cells.append(f"{statistics.median(one[kind] for one in rounds):.2f} s")
            cells.append(f"{statistics.median(one[kind] / one['program'] for one in rounds):.2f}")
        print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
