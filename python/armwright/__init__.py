"""armwright tunes robot arms by simulation with interchangeable gradient-free optimizers. This package is its Python interface.

    >>> import armwright
    >>> problem = armwright.load_problem("q1-complex", set={"physics.engine": "articulated"})
    >>> run = armwright.optimize(problem, "cmaes", seed=1, budget=2000)
    >>> run.summary["mean"]                            # metres, on the test set

Problem.evaluate() evaluates points. Problem.evaluate_design() judges a design. To write an optimizer, derive a class from Optimizer.
For a problem of your own, derive one from UserProblem, or call make_problem(). compare() compares optimizers. identify() finds a robot's plant in
recorded motions. docs/python.md describes all of this. The results are the same as those of the program `armwright`, bit for bit.
"""

try:
    from . import _armwright
except ImportError as error:
    from ._missing_module import explain

    raise ImportError(explain(error)) from None
from .description import Description, Quantity, Variable
from .errors import ArmwrightWarning, BadDataError, BusyError, Error, IoError, UsageError
from .identification import identify
from .optimizer import CAPABILITIES, Evaluator, Finding, Optimizer, OptimizerInfo, Option, Scores, check_optimizer, optimizers
from .problem import DesignEvaluation, Evaluations, Problem, list_designs, list_problems, load_problem
from .progress import Progress
from .run import History, Run, load_run, optimize
from .search import AskedPoint, Search
from .server import serve
from .study import Study, compare, load_study
from .user_problem import Answer, Case, Category, Constraint, Failed, Integer, Objective, Real, Record, UserProblem, make_problem

__version__: str = _armwright.version()

__all__ = [
    "Answer",
    "ArmwrightWarning",
    "AskedPoint",
    "BadDataError",
    "BusyError",
    "CAPABILITIES",
    "Case",
    "Category",
    "Constraint",
    "Description",
    "DesignEvaluation",
    "Error",
    "Evaluations",
    "Evaluator",
    "Failed",
    "Finding",
    "History",
    "Integer",
    "IoError",
    "Objective",
    "Optimizer",
    "OptimizerInfo",
    "Option",
    "Problem",
    "Progress",
    "Quantity",
    "Real",
    "Record",
    "Run",
    "Scores",
    "Search",
    "Study",
    "UsageError",
    "UserProblem",
    "Variable",
    "check_optimizer",
    "compare",
    "identify",
    "list_designs",
    "list_problems",
    "load_problem",
    "load_run",
    "load_study",
    "make_problem",
    "optimize",
    "optimizers",
    "serve",
]
