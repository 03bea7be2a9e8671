"""Runs an optimizer on the problem "slow-squares" of problem.py as a class, with the words of `armwright optimize`."""
import argparse
import math
import time

import armwright


class Squares(armwright.UserProblem):
    variables = [armwright.Real("x", -5, 5, start=3), armwright.Integer("n", -3, 8, start=2), armwright.Category("word", ["plain", "dear"])]
    objectives = ["f"]
    residuals = True

    def evaluate(self, x, case):
        time.sleep(0.001)
        return armwright.Answer(residuals=[x["x"] - 1.5, 0.5 * x["n"], 1.0 if x["word"] == "dear" else 0.25, math.sin(3 * x["x"])])


parser = argparse.ArgumentParser()
parser.add_argument("words", nargs=2)  # the program that this script takes the place of, and "optimize"
parser.add_argument("--optimizer")
for name in ("budget", "jobs"):
    parser.add_argument("--" + name, type=int)
parser.add_argument("--out")
parser.add_argument("--quiet", action="store_true")
run = parser.parse_args()
armwright.optimize(Squares, run.optimizer, budget=run.budget, out=run.out, jobs=run.jobs)
