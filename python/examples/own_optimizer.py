"""Compares an optimizer of fifteen lines with CMA-ES, random search and a local search under the same conditions.

    /usr/bin/python3 own_optimizer.py [REPLICATES [BUDGET]]

The study is stored in results/own_optimizer. Start this program again to continue it. `armwright show`, `report` and `export` read it.
"""
import sys

import armwright
import numpy as np


class Hillclimber(armwright.Optimizer):
    """Tries eight steps at a time from the incumbent. Steps become longer after a success and shorter after a failure."""

    capabilities = ("bounds", "batch", "stochastic")

    def minimize(self, evaluator, seed):
        random, problem, step = np.random.default_rng(seed), evaluator.problem, 0.1
        best = problem.to_unit(problem.start)
        least = evaluator.evaluate(problem.from_unit(best)).values
        while not evaluator.stopped:
            tries = np.clip(best + step * random.standard_normal((8, len(problem))), 0, 1)
            values = evaluator.evaluate(problem.from_unit(tries)).values
            is_better = len(values) > 0 and values.min() < least.min()
            best, least = (tries[values.argmin()], values) if is_better else (best, least)
            step *= 1.3 if is_better else 0.8


if __name__ == "__main__":
    replicates = int(sys.argv[1]) if len(sys.argv) > 1 else 8
    budget = int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    study = armwright.compare(["q1-complex"], [Hillclimber, "cmaes"], replicates=replicates, budget=budget,
                              set={"physics.engine": "articulated"}, out="results/own_optimizer")
    for optimizer, row in study.table("q1-complex").items():
        print(f"{optimizer:20} median {1000 * np.median(study.values[study.optimizers.index(optimizer)]):8.2f} mm")
    print("\n".join(study.verdict))
