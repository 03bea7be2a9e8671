"""Ask and tell: a run whose points you evaluate yourself."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np

from . import _armwright
from ._values import Settings, to_options, to_whole
from .errors import UsageError
from .optimizer import AnyOptimizer, to_row
from .problem import Problem, load_problem
from .progress import Listener
from .run import LARGEST_SEED, Run, load_run, own_command
from .user_problem import AnswerForm, AnyUserProblem, Failed, Point, Returned

_MOST_POINTS = 1_000_000


@dataclass(frozen=True)
class AskedPoint:
    """A point that waits for its result. `x` is an array (d,) if all variables are real, else a dict of the values by name."""

    id: int
    x: Point


class Search:
    """A run whose points you evaluate yourself, for example on hardware or in another system's queue.

    The folder of the run is an ordinary one. Another Search with the same arguments continues it, as does `armwright ask` for a problem file.

    Parameters
    ----------
    problem : Problem, UserProblem, class derived from it, str or path
        A problem of your own with a single case. Only its description is used; it is never evaluated. A problem file with
        kind = "external" has nothing but the description.
    optimizer, budget, seed, options, set, out
        As for optimize().

    Attributes
    ----------
    folder : Path
    finished : bool
        Whether the run has ended. It then has a result, and no more points.

    Examples
    --------
    >>> search = armwright.Search("bench.toml", "cmaes", budget=60, out="results/bench")
    >>> while points := search.ask(4):
    ...     for point in points:
    ...         search.tell(point, measure(point.x))
    >>> search.result().x
    """

    def __init__(
        self,
        problem: Union[Problem, AnyUserProblem, str, Path],
        optimizer: Optional[AnyOptimizer] = None,
        *,
        budget: Optional[int] = None,
        seed: int = 1,
        options: Optional[Mapping[str, Any]] = None,
        set: Optional[Settings] = None,
        out: Union[None, str, Path] = None,
    ) -> None:
        if not isinstance(problem, Problem):
            problem = load_problem(problem, set=set)
        elif set is not None:
            raise UsageError("set applies only to a problem that is given by its name; for a loaded problem use load_problem(..., set=...)")
        self._problem = problem
        chosen: AnyOptimizer = problem.optimizer if optimizer is None else optimizer
        self._row = to_row(chosen)
        self._options = to_options(options)
        self._seed = to_whole("seed", seed, LARGEST_SEED)
        self._budget = budget
        self._command = own_command() if problem._inner.is_python or not isinstance(chosen, str) else []
        self._form = AnswerForm(*problem._inner.outputs())
        self._out = None if out is None else str(out)
        self._waiting: dict[int, AskedPoint] = {}
        self.finished = False
        self._ask(0)

    def __repr__(self) -> str:
        state = "finished" if self.finished else f"{len(self._waiting)} points wait for results"
        return f"<armwright.Search {self.folder}: {state}>"

    def _make_point(self, id: int, x: Sequence[float]) -> AskedPoint:
        if not self._problem.is_discrete.any():
            return AskedPoint(id, np.array(x, dtype=np.float64))
        values: dict[str, Any] = {}
        for variable, value in zip(self._problem.variables, x):
            values[variable.name] = (value if variable.type == "real" else
                                     int(value) if variable.type == "integer" else variable.choices[int(value)])
        return AskedPoint(id, values)

    def _ask(self, count: int) -> list[AskedPoint]:
        with Listener(False) as listener:
            folder, points, waiting, self.finished = _armwright.ask(
                self._problem._inner, self._row, self._options, self._seed, self._budget, self._out, self._command, count, listener)
        self.folder = Path(folder)
        self._out = folder
        made = [self._make_point(*one) for one in points]
        self._waiting = {point.id: point for point in [*(self._make_point(*one) for one in waiting), *made]}
        return made

    def ask(self, n: Optional[int] = None) -> list[AskedPoint]:
        """Returns at most `n` points of those that the optimizer asks for together; by default all of them. A sequential optimizer asks for one.

        No point is returned twice. The list is empty if the optimizer first needs the results of points that wait, or if the run has ended.
        """
        if n is not None and to_whole("n", n, _MOST_POINTS) == 0:
            raise UsageError("n is 0; it must be at least 1. waiting has the points without a result")
        return self._ask(_MOST_POINTS if n is None else n)

    @property
    def waiting(self) -> list[AskedPoint]:
        """The points that were handed out and have no result yet, also those of an earlier Search."""
        return list(self._waiting.values())

    def tell(self, point: Union[AskedPoint, int], value: Optional[Returned] = None, *, missing: Optional[str] = None) -> None:
        """Records the result of a point, or why there is none. Points may be told in any order, each of them once.

        `point` is a point of ask() or its identifier. `value` is what UserProblem.evaluate() returns. UsageError or BadDataError if the
        identifier was never handed out or has a result, or if the value does not fit the problem; the run is then unchanged.
        """
        id = to_whole("id", point.id if isinstance(point, AskedPoint) else point, 2**63 - 1)
        if (value is None) == (missing is None):
            raise UsageError(f"point {id}: give either its value, or missing= with the reason why there is none")
        if isinstance(value, Failed):
            missing = value.reason
        line: Any = {"missing": missing}
        if missing is None:
            line = self._form.convert(value, True)
            if not isinstance(line, dict):
                line = {"objectives": [line]}
            for name, numbers in line.items():
                if isinstance(numbers, str):
                    raise UsageError(f"point {id}: its value is {numbers}; it must be what UserProblem.evaluate() returns")
                if not all(math.isfinite(number) for number in numbers):
                    raise UsageError(f"point {id}: its {name} are {numbers}; they must be finite. If there is no result, give missing=")
        _armwright.tell(self._problem._inner, str(self.folder), json.dumps({"id": id, **line}))
        self._waiting.pop(id, None)

    def result(self) -> Run:
        """Returns the run. Ends it first if its budget is spent and every point has a result; otherwise the Run is not `finished`."""
        self._ask(0)
        return load_run(self.folder)
