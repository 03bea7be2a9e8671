#!/usr/bin/python3
"""Counts the evaluations of the published program DFO-LS on the problems of More and Wild.

The problems are those of dfls_benchmark, which evaluates them (--serve). The budget is 50 (n + 1)
evaluations, and every setting is DFO-LS's default. Writes the columns of dfls_benchmark as CSV, with
the version of DFO-LS in a comment. DFO-LS (https://github.com/numericalalgorithmsgroup/dfols) is no
dependency of armwright: put its folder into PYTHONPATH.

  PYTHONPATH=DFOLS benchmarks/more_wild/run_dfols.py build/release/bin/dfls_benchmark > benchmarks/more_wild/dfols.csv
"""

import contextlib
import csv
import pathlib
import subprocess
import sys
import warnings

import dfols
import numpy

TAUS = (1e-1, 1e-3, 1e-5)


class Problem:
    """A problem that counts its evaluations and notes when it is solved."""

    def __init__(self, server, number, best_known):
        self.server = server
        self.number = number
        self.start = self.ask()
        self.best_known = best_known
        residuals = self.ask(self.start)
        self.m = len(residuals)
        self.f_0 = float(residuals @ residuals)
        self.count = 0
        self.best = float("inf")
        self.solved = [None] * len(TAUS)

    def ask(self, x=()):
        self.server.stdin.write(" ".join([str(self.number), *(repr(float(value)) for value in x)]) + "\n")
        self.server.stdin.flush()
        return numpy.array([float(word) for word in self.server.stdout.readline().split()])

    def __call__(self, x):
        residuals = self.ask(x)
        f = float(residuals @ residuals)
        self.count += 1
        if f < self.best:
            self.best = f
        for i, tau in enumerate(TAUS):
            if self.solved[i] is None and f <= self.best_known + tau * (self.f_0 - self.best_known):
                self.solved[i] = self.count
        return residuals


def main():
    warnings.simplefilter("ignore")
    folder = pathlib.Path(__file__).parent
    server = subprocess.Popen([sys.argv[1], "--serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    with open(folder / "best_known.csv", encoding="utf-8") as file:
        best_known = [float(row["f_L"]) for row in csv.DictReader(file)]
    with open(folder / "dfls.csv", encoding="utf-8") as file:
        names = [row["name"] for row in csv.DictReader(file)]
    print(f"# DFO-LS {dfols.__version__}, default settings")
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow("problem name n m f_0 tau_1e-1 tau_1e-3 tau_1e-5 f_best evaluations".split())
    for i, name in enumerate(names):
        problem = Problem(server, i + 1, best_known[i])
        with contextlib.redirect_stdout(sys.stderr):
            dfols.solve(problem, problem.start, maxfun=50 * (len(problem.start) + 1))
        writer.writerow([i + 1, name, len(problem.start), problem.m, f"{problem.f_0:.6g}", *problem.solved,
                         f"{problem.best:.10g}", problem.count])
        sys.stdout.flush()


if __name__ == "__main__":
    main()
