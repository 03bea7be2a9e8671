"""Problems of your own: the base class, and what its methods get and return."""

from __future__ import annotations

import base64
import hashlib
import io
import json
import math
import os
import re
import sys
import time
from dataclasses import dataclass, field
from typing import Any, Callable, ClassVar, Iterable, Iterator, Mapping, NamedTuple, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from ._values import FloatArray
from .description import Quantity
from .errors import UsageError
from .optimizer import canonical_text, describe_member, first_line_of_doc, hash_class

_SENDING_S = 0.5  # after this time, answers that are there are sent
_LONGEST_REASON = 300
_FAILURES = ("failed", "diverged", "unreachable")


class _Described:
    """The base of data classes that are objects of the protocol. Fields without a value are left out."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    def describe(self) -> dict[str, Any]:
        content = {key: getattr(self, key) for key in self.__dataclass_fields__}
        return {key: value for key, value in content.items() if value is not None and value != ""}


@dataclass(frozen=True)
class Real(_Described):
    """A decision variable that is a real number. `start` is the middle of the bounds by default, on the scale of the variable.

    `scale` is "linear" or "logarithmic"; both bounds of a logarithmic variable have the same sign.
    """

    name: str
    lower: float
    upper: float
    unit: str = ""
    start: Optional[float] = None
    scale: str = "linear"


@dataclass(frozen=True)
class Integer(_Described):
    """A decision variable that is a whole number; as Real."""

    name: str
    lower: int
    upper: int
    unit: str = ""
    start: Optional[int] = None
    scale: str = "linear"
    type: str = field(default="integer", init=False)


@dataclass(frozen=True)
class Category(_Described):
    """A decision variable that is one of two words or more, which have no order. `start` is the first word by default."""

    name: str
    choices: Sequence[str]
    start: Optional[str] = None
    unit: str = ""
    type: str = field(default="category", init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "choices", tuple(self.choices))
        if self.start is None and self.choices:
            object.__setattr__(self, "start", self.choices[0])


@dataclass(frozen=True)
class Objective(_Described):
    """A number that is minimised. `direction` "maximize" maximises it.

    `weight` counts where one number is needed for several objectives. `penalty` is what a failed training case counts as; without it, a point
    with a failed case has no objectives. No case has a better value than `bound`; races use it.
    """

    name: str
    unit: str = ""
    direction: str = "minimize"
    weight: float = 1.0
    penalty: Optional[float] = None
    bound: Optional[float] = None


@dataclass(frozen=True)
class Constraint(_Described):
    """A number that is limited: the constraint is met if it is at most `limit`, or at most 0 without a limit."""

    name: str
    unit: str = ""
    limit: Optional[float] = None


class Case(NamedTuple):
    """One test case of a problem.

    Attributes
    ----------
    role : str
        "training", "validation" or "test".
    set : str
        The name of the set, for example "train/1". Cases of different sets must differ.
    number : int
        The number of the case within its set, from 0.
    seed : int
        A number below 2**53 that belongs to this set and number. Random numbers of the case come from it. It is 0 if the problem is
        deterministic and has only one case.
    """

    role: str
    set: str
    number: int
    seed: int


@dataclass(frozen=True)
class Answer:
    """The numbers of one case, in the order of the description. With residuals, the objective may be left out: it is the sum of their squares."""

    objectives: Sequence[float] = ()
    constraints: Sequence[float] = ()
    metrics: Sequence[float] = ()
    residuals: Optional[npt.ArrayLike] = None


class Failed(Exception):
    """Raise or return it for a case without numbers. `status` is "failed", "diverged" or "unreachable"."""

    def __init__(self, reason: str, status: str = "failed") -> None:
        super().__init__(reason)
        self.reason = reason
        self.status = status
        if status not in _FAILURES:
            raise UsageError(f"status is {status!r}; it must be among {', '.join(_FAILURES)}")


@dataclass(frozen=True)
class Record:
    """What a case leaves beside its numbers: curves and files.

    Attributes
    ----------
    abscissa : (name, unit, values), optional
        What the curves are drawn over, for example ("time", "s", t).
    series : sequence of (name, unit, values)
        Curves, each with as many values as the abscissa.
    files : mapping of str to str, bytes or figure
        The contents of files by name. A figure is an object with savefig(), as matplotlib's; it is saved in the format of the name's suffix.
    """

    abscissa: Optional[tuple[str, str, npt.ArrayLike]] = None
    series: Sequence[tuple[str, str, npt.ArrayLike]] = ()
    files: Mapping[str, Any] = field(default_factory=dict)


# The values of one point: an array (d,) if all variables are real, else the values by name.
Point = Any
Returned = Union[float, Sequence[float], Mapping[str, float], Answer, Failed, FloatArray]


class UserProblem:
    """The base class for your own problem. Pass the derived class, or an object of it, to optimize(), compare(), load_problem() or serve().

    Derive evaluate(), or evaluate_batch() if many points at once are faster. The same point on the same case must have the same numbers,
    whatever was evaluated before it.

    Attributes
    ----------
    name : str
        Letters, digits, "_", "-" and "."; results have "python:NAME". Default: the name of the class.
    summary : str
        One line. Default: the first line of the docstring.
    variables : sequence of Real, Integer and Category
    objectives : sequence of Objective or str
    constraints : sequence of Constraint or str
    metrics : sequence of Quantity or str
        Other numbers that are recorded.
    residuals : bool
        Whether answers have residuals. The only objective is then the sum of their squares.
    cases : mapping
        How many cases there are: "training", "validation" and "test". Default: 1 of each. 0 training cases: as many as a schedule asks for.
    combine : str
        How objectives of several cases are combined, "mean" or "worst".
    deterministic : bool
        Whether the same question has the same answer.
    isolate : bool
        Whether worker processes evaluate even if jobs is 1. With more jobs they always do.
    time_limit_s, memory_mib : float
        Limits of a case in a worker process. A case that takes longer, a worker that takes more memory than when it began, or one that
        crashes, is a failed case with a reason.

    Examples
    --------
    >>> class Bowl(armwright.UserProblem):
    ...     variables = [armwright.Real("a", -5, 5), armwright.Real("b", -5, 5)]
    ...     def evaluate(self, x, case):
    ...         return ((x - 1) ** 2).sum()
    >>> run = armwright.optimize(Bowl, "cmaes", budget=500)
    """

    name: str = ""
    summary: str = ""
    variables: Sequence[Union[Real, Integer, Category]] = ()
    objectives: Sequence[Union[Objective, str]] = ("objective",)
    constraints: Sequence[Union[Constraint, str]] = ()
    metrics: Sequence[Union[Quantity, str]] = ()
    residuals: bool = False
    cases: Mapping[str, int] = {"training": 1, "validation": 1, "test": 1}
    combine: str = "mean"
    deterministic: bool = True
    isolate: bool = False
    time_limit_s: float = 60.0
    memory_mib: float = 4096.0

    def evaluate(self, x: Point, case: Case) -> Returned:
        """Returns the numbers of a point on a case.

        `x` is an array (d,) if all variables are real. Otherwise it is a dict of the values by name; those of integers are int, those of
        categories str. Return a number (the objective), a sequence (every objective, then every constraint, then every metric), a dict of
        the same by name, an Answer, or a Failed. An exception makes a failed case whose reason is the exception.
        """
        raise NotImplementedError(f"{type(self).__name__} has no evaluate(self, x, case)")

    def evaluate_batch(self, points: Any, cases: Sequence[Case]) -> Iterable[Returned]:
        """Returns what evaluate() returns for every pair of a point and a case. `points` is an array (n, d), or a list of dicts."""
        raise NotImplementedError(f"{type(self).__name__} has no evaluate_batch(self, points, cases)")

    def record(self, x: Point, case: Case) -> Record:
        """Returns curves and files of a point on a case. They are made for the winner only."""
        raise NotImplementedError(f"{type(self).__name__} has no record(self, x, case)")


class _Function(UserProblem):
    """A function of a point as a problem."""

    def __init__(self, function: Callable[[Any], Returned], settings: Mapping[str, Any]) -> None:
        self.function = function
        for name, value in settings.items():
            if not hasattr(UserProblem, name) or name.startswith("_") or callable(getattr(UserProblem, name)):
                raise UsageError(f"make_problem() has no argument {name!r}; possible are start, names, types, and the attributes of UserProblem")
            setattr(self, name, value)

    def evaluate(self, x: Point, case: Case) -> Returned:
        return self.function(x)


def make_problem(
    function: Callable[[Any], Returned],
    lower: Sequence[float],
    upper: Sequence[float],
    *,
    start: Optional[Sequence[float]] = None,
    names: Optional[Sequence[str]] = None,
    types: Optional[Sequence[Union[str, Sequence[str]]]] = None,
    **settings: Any,
) -> UserProblem:
    """Makes a problem of a function of one point, which returns what UserProblem.evaluate() returns.

    Parameters
    ----------
    lower, upper : sequences (d,)
        The bounds. Those of a category are ignored.
    start, names : sequences (d,), optional
        Default: the middle of the bounds, and "x1", "x2", ...
    types : sequence (d,), optional
        "real" (the default), "integer", or the list of words of a category, per variable.
    settings : optional
        Any attribute of UserProblem. `name` is the function's name by default.

    Examples
    --------
    >>> problem = armwright.make_problem(lambda x: ((x - 1) ** 2).sum(), [-5, -5], [5, 5], name="bowl")
    """
    if not callable(function):
        raise UsageError(f"the function is {function!r}; it must be callable with one point")
    size = len(lower)
    for what, given in (("upper", upper), ("start", start), ("names", names), ("types", types)):
        if given is not None and len(given) != size:
            raise UsageError(f"{what} has {len(given)} values and lower has {size}; both must have one per variable")
    variables: list[Union[Real, Integer, Category]] = []
    for i in range(size):
        name = f"x{i + 1}" if names is None else names[i]
        kind = "real" if types is None else types[i]
        first: Any = None if start is None else start[i]
        if not isinstance(kind, str):
            variables.append(Category(name, kind, first))
        elif kind == "integer":
            variables.append(Integer(name, int(lower[i]), int(upper[i]), start=None if first is None else int(first)))
        elif kind == "real":
            variables.append(Real(name, float(lower[i]), float(upper[i]), start=None if first is None else float(first)))
        else:
            raise UsageError(f'types[{i}] is {kind!r}; it must be "real", "integer" or a list of words')
    given_name = getattr(function, "__name__", type(function).__name__)
    named: dict[str, Any] = {"name": re.sub(r"[^A-Za-z0-9_.-]", "", given_name) or "function", "summary": first_line_of_doc(function)}
    return _Function(function, {**named, **settings, "variables": variables})


AnyUserProblem = Union[UserProblem, type[UserProblem]]


def is_user_problem(problem: object) -> bool:
    return isinstance(problem, UserProblem) or (isinstance(problem, type) and issubclass(problem, UserProblem))


class AnswerForm:
    """Converts what evaluate() returned for a point into an answer of the protocol, for a problem with these objectives, constraints and metrics."""

    def __init__(self, objectives: Sequence[str], constraints: Sequence[str], metrics: Sequence[str]) -> None:
        self._outputs = [*objectives, *constraints, *metrics]
        self._objectives, self._constraints = len(objectives), len(constraints)
        self._is_single = len(self._outputs) == 1

    def convert(self, returned: Any, wants_residuals: bool) -> Any:
        """Returns the answer in the form of the protocol. The host refuses an answer that breaks the contract, so it gets a text that says how."""
        try:
            if isinstance(returned, Failed):
                return {"status": returned.status, "reason": returned.reason}
            if isinstance(returned, Mapping):
                missing = [name for name in self._outputs if name not in returned]
                unknown = [name for name in returned if name not in self._outputs]
                if missing or unknown:
                    raise _Wrong(f"a dict without {missing[0]!r}" if missing else f"a dict with the unknown name {unknown[0]!r}")
                returned = [returned[name] for name in self._outputs]
            if isinstance(returned, Answer):
                return self._convert_answer(returned, wants_residuals)
            if isinstance(returned, _Wrong):
                raise returned
            if isinstance(returned, str):
                raise TypeError
            values = _to_floats(returned) if isinstance(returned, (list, tuple)) or np.ndim(returned) > 0 else [float(returned)]
            if self._is_single and len(values) == 1:
                return values[0]
            ends = (self._objectives, self._objectives + self._constraints)
            return {"objectives": values[:ends[0]], "constraints": values[ends[0]:ends[1]], "metrics": values[ends[1]:]}
        except _Wrong as wrong:
            return {"objectives": str(wrong)}
        except (TypeError, ValueError, OverflowError):
            return {"objectives": f"{type(returned).__name__}: {_shorten(repr(returned))}"}

    def _convert_answer(self, answer: Answer, wants_residuals: bool) -> dict[str, Any]:
        objectives = _to_floats(answer.objectives)
        residuals = None if answer.residuals is None else _to_floats(answer.residuals)
        if not objectives and residuals is not None:
            objectives = [math.fsum(one * one for one in residuals)]
        converted: dict[str, Any] = {"objectives": objectives, "constraints": _to_floats(answer.constraints),
                                     "metrics": _to_floats(answer.metrics)}
        if wants_residuals and residuals is not None:
            converted["residuals"] = residuals
        return converted


class PythonProblem(AnswerForm):
    """A problem in the form that the library and the protocol of docs/problem-protocol.md take. UsageError says what is wrong with it."""

    def __init__(self, problem: AnyUserProblem) -> None:
        own: UserProblem = problem() if isinstance(problem, type) else problem
        cls = type(own)
        self.problem = own
        self.is_batched = cls.evaluate_batch is not UserProblem.evaluate_batch
        if not self.is_batched and cls.evaluate is UserProblem.evaluate:
            raise UsageError(f"{cls.__name__} has no evaluate(self, x, case) and no evaluate_batch(self, points, cases)")
        variables, objectives, constraints, metrics = (
            [_describe(one, f"{name}[{i}]") for i, one in enumerate(getattr(own, name))]
            for name in ("variables", "objectives", "constraints", "metrics"))
        self.description: dict[str, Any] = {
            "type": "problem",
            "protocol": 1,
            "name": own.name or cls.__name__,
            "summary": own.summary or first_line_of_doc(cls),
            "variables": variables,
            "objectives": objectives,
            "constraints": constraints,
            "metrics": metrics,
            "residuals": bool(own.residuals),
            "cases": dict(own.cases),
            "combine": own.combine,
            "deterministic": bool(own.deterministic),
            "records": cls.record is not UserProblem.record,
            "version": _calc_version(own),
        }
        try:
            self.text = json.dumps(self.description, default=_to_plain)
        except TypeError as error:
            raise UsageError(f"{cls.__name__} describes itself with a value that is no number and no text: {error}") from None
        self._names = [one["name"] for one in variables]
        super().__init__(*([one["name"] for one in kind] for kind in (objectives, constraints, metrics)))
        self._is_all_real = all("type" not in one for one in variables)

    @property
    def full_name(self) -> str:
        return f"python:{self.description['name']}"

    def answer(self, question: str, send: Callable[[str], object]) -> None:
        """Answers the message "evaluate" or "record" of the protocol. Sends the answers that are there about twice per second."""
        self.answer_message(json.loads(question), send)

    def answer_message(self, message: dict[str, Any], send: Callable[[str], object]) -> None:
        if message["type"] == "record":
            send(json.dumps(self._record(message)))
            return
        batch: list[Any] = []
        last = time.monotonic()
        for one in self._answer_all(message):
            batch.append(one)
            now = time.monotonic()
            if now - last > _SENDING_S:
                send(json.dumps({"type": "answers", "id": message["id"], "answers": batch}))
                batch, last = [], now
        if batch:
            send(json.dumps({"type": "answers", "id": message["id"], "answers": batch}))

    def _make_points(self, message: dict[str, Any]) -> Any:
        if self._is_all_real:
            return np.array(message["points"], dtype=np.float64)
        return [dict(zip(self._names, point)) for point in message["points"]]

    @staticmethod
    def _make_cases(message: dict[str, Any]) -> list[Case]:
        numbers = message["cases"]
        role, name = message["role"], message["set"]
        return [Case(role, name, number, seed) for number, seed in zip(numbers, message.get("seeds") or [0] * len(numbers))]

    def _answer_all(self, message: dict[str, Any]) -> Iterator[Any]:
        points, cases = self._make_points(message), self._make_cases(message)
        wants_residuals = message.get("residuals", False)
        if not self.is_batched:
            evaluate = self.problem.evaluate
            for point, case in zip(points, cases):
                try:
                    returned = evaluate(point, case)
                except (Exception, SystemExit) as exception:
                    returned = _make_failure(exception)
                yield returned if self._is_single and isinstance(returned, float) else self.convert(returned, wants_residuals)
            return
        try:
            all_returned: list[Any] = list(self.problem.evaluate_batch(points, cases))
        except (Exception, SystemExit) as exception:
            all_returned = [_make_failure(exception)] * len(cases)
        if len(all_returned) != len(cases):
            all_returned = [_Wrong(f"evaluate_batch() returned {len(all_returned)} answers to {len(cases)} points")] * len(cases)
        for returned in all_returned:
            yield self.convert(returned, wants_residuals)

    def _record(self, message: dict[str, Any]) -> dict[str, Any]:
        record: Any = self.problem.record(self._make_points(message)[0], self._make_cases(message)[0])
        if not isinstance(record, Record):
            raise TypeError(f"record() returned a {type(record).__name__}; it must return an armwright.Record")
        content: dict[str, Any] = {"type": "record", "id": message["id"]}
        if record.abscissa is not None:
            content["abscissa"] = _describe_curve(record.abscissa)
        content["series"] = [_describe_curve(one) for one in record.series]
        content["files"] = [_describe_file(name, given) for name, given in record.files.items()]
        return content


class _Wrong(Exception):
    """An answer that breaks the contract."""


def _describe(one: Any, what: str) -> dict[str, Any]:
    if isinstance(one, str):
        return {"name": one}
    if isinstance(one, Quantity):
        return {"name": one.name, "unit": one.unit}
    if not isinstance(one, _Described):
        raise UsageError(f"{what} is {one!r}; variables are Real, Integer or Category, objectives Objective, constraints Constraint, metrics "
                         "Quantity; a name alone may stand for the last three")
    return one.describe()


def _to_plain(value: Any) -> Any:
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TypeError(f"{value!r}")


def _to_floats(values: Any) -> list[float]:
    return [float(one) for one in values]


def _shorten(text: str) -> str:
    """Returns a text in one line that does not depend on addresses of objects."""
    return re.sub(r"0x[0-9a-fA-F]{6,}", "0x...", " ".join(text.split()))[:_LONGEST_REASON]


def _make_failure(exception: BaseException) -> Failed:
    if isinstance(exception, Failed):
        return exception
    said = str(exception)
    return Failed(_shorten(f"{type(exception).__name__}: {said}" if said else type(exception).__name__))


def _describe_curve(curve: tuple[str, str, npt.ArrayLike]) -> dict[str, Any]:
    name, unit, values = curve
    return {"name": name, "unit": unit, "values": np.asarray(values, dtype=np.float64).ravel().tolist()}


def _describe_file(name: str, content: Any) -> dict[str, Any]:
    if hasattr(content, "savefig"):
        buffer = io.BytesIO()
        content.savefig(buffer, format=os.path.splitext(name)[1].lstrip(".") or "png")
        content = buffer.getvalue()
    if isinstance(content, str):
        return {"name": name, "text": content}
    return {"name": name, "base64": base64.b64encode(bytes(content)).decode()}


def _calc_version(problem: UserProblem) -> str:
    """Returns a hash of the source text and the public attributes. It changes if the problem computes something else."""
    parts = [hash_class(type(problem), UserProblem, without=("__module__",))]
    for name, value in sorted(vars(problem).items()):
        if not name.startswith("_"):
            try:
                parts.append(f"{name} {canonical_text(value, name)}")
            except UsageError:
                parts.append(f"{name} {describe_member(value)}")
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:16]


def enter_worker() -> None:
    """Prepares a forked process: text that the problem prints goes to standard error."""
    sys.stdin = open(os.devnull, encoding="utf-8")
    sys.stdout = sys.stderr = open(2, "w", encoding="utf-8", errors="replace", buffering=1, closefd=False)
