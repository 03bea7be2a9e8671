"""Solves the thesis's first problem with SciPy's differential evolution and evaluates each generation on all cores.

    /usr/bin/python3 scipy_optimize.py [GENERATIONS]

SciPy has no budgets, journals or test sets. It minimises the arm's error on five training cases like any other function. Afterwards the
program evaluates the best design on the test set, which no optimizer uses. It needs python3-scipy.
"""
import sys

import armwright
from scipy.optimize import differential_evolution

generations = int(sys.argv[1]) if len(sys.argv) > 1 else 30
problem = armwright.load_problem("q1-complex", set={"physics.engine": "articulated"})


def calc_errors(columns):  # one column per point, from 0 to 1 between the bounds on each variable's scale
    return problem.evaluate(problem.from_unit(columns.T), cases=5).values


result = differential_evolution(calc_errors, bounds=[(0, 1)] * len(problem), x0=problem.to_unit(problem.start), maxiter=generations,
                                popsize=2, seed=1, polish=False, vectorized=True, updating="deferred")
x = problem.from_unit(result.x)
print(f"training: {1000 * problem.evaluate(problem.start, cases=5).values[0]:.2f} mm at the start, {1000 * result.fun:.2f} mm after "
      f"{result.nfev} evaluations")
summary = problem.evaluate_design(x, cases=100).summary
print(f"test set: mean {1000 * summary['mean_error_m']:.2f} mm, {summary['failures']} failures of {summary['cases']}")
