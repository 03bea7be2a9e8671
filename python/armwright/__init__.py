"""armwright tunes robot arms by simulation with interchangeable gradient-free optimizers; this drives it from Python.

    >>> import armwright
    >>> problem = armwright.load_problem("q1-complex", set={"physics.engine": "articulated"})
    >>> run = armwright.optimize(problem, "cmaes", seed=1, budget=2000)
    >>> run.summary["mean"]                            # metres, on the test set

Evaluate points: Problem.evaluate(). Judge a design: Problem.evaluate_design(). Write an optimizer: derive a class from Optimizer. Settle
which is better: compare(). docs/python.md goes through all of it. What is run here and by the program `armwright` is the same, bit for bit.
"""

from . import _armwright
from .description import Description, Quantity, Variable
from .errors import ArmwrightWarning, BadDataError, BusyError, Error, IoError, UsageError
from .optimizer import CAPABILITIES, Evaluator, Finding, Optimizer, OptimizerInfo, Option, Scores, check_optimizer, optimizers
from .problem import DesignEvaluation, Evaluations, Problem, list_designs, list_problems, load_problem
from .progress import Progress
from .run import History, Run, load_run, optimize
from .server import serve
from .study import Study, compare, load_study

__version__: str = _armwright.version()

__all__ = [
    "ArmwrightWarning",
    "BadDataError",
    "BusyError",
    "CAPABILITIES",
    "Description",
    "DesignEvaluation",
    "Error",
    "Evaluations",
    "Evaluator",
    "Finding",
    "History",
    "IoError",
    "Optimizer",
    "OptimizerInfo",
    "Option",
    "Problem",
    "Progress",
    "Quantity",
    "Run",
    "Scores",
    "Study",
    "UsageError",
    "Variable",
    "check_optimizer",
    "compare",
    "list_designs",
    "list_problems",
    "load_problem",
    "load_run",
    "load_study",
    "optimize",
    "optimizers",
    "serve",
]
