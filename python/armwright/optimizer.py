"""Optimizers: the list of available ones, and the base class for your own."""

from __future__ import annotations

import copy
import hashlib
import inspect
import json
import traceback
import types
from dataclasses import dataclass, field
from typing import Any, Callable, ClassVar, Iterable, Mapping, Optional, Protocol, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _armwright
from ._values import FloatArray, MaskedFloats, to_masked, to_masked_matrices, to_options, to_points
from .description import Description
from .errors import UsageError

OptionValue = Union[bool, int, float, str]
CAPABILITIES = ("bounds", "constraints", "multi_objective", "batch", "noisy", "residuals", "stochastic", "generations", "local", "sampling",
                "paced", "integer", "categorical")
_LARGEST_INTEGER = 2**53  # the largest integer below which doubles represent every integer
_LARGEST_NUMBER = 1e300
_LAST_LINES = 10  # that are kept of a traceback


@dataclass(frozen=True)
class Option:
    """An option of an optimizer. The type of the default is the type of the option: bool, int, float or str.

    `lower` and `upper` are the closed range of allowed numbers. `choices` are the allowed texts; if it is empty, any text is allowed.
    """

    name: str
    default: OptionValue
    description: str = ""
    lower: Optional[float] = None
    upper: Optional[float] = None
    choices: Sequence[str] = ()

    def describe(self) -> dict[str, Any]:
        """Returns the option in the form of the plugin protocol."""
        content: dict[str, Any] = {"name": self.name, "default": self.default, "description": self.description}
        if isinstance(self.default, str):
            if self.choices:
                content["choices"] = list(self.choices)
        elif not isinstance(self.default, bool):
            most = _LARGEST_INTEGER if isinstance(self.default, int) else _LARGEST_NUMBER
            content["lower"] = -most if self.lower is None else self.lower
            content["upper"] = most if self.upper is None else self.upper
        return content


@dataclass(frozen=True)
class OptimizerInfo:
    """A known optimizer. `capabilities` is a subset of CAPABILITIES. `unavailable` says why it cannot be used here ("" if it can)."""

    name: str
    summary: str
    source: str
    capabilities: frozenset[str]
    options: tuple[Option, ...]
    requirements: dict[str, Any]
    unavailable: str


def _make_info(content: dict[str, Any]) -> OptimizerInfo:
    options = tuple(Option(**{key: one[key] for key in Option.__dataclass_fields__}) for one in content["options"])
    return OptimizerInfo(content["name"], content["summary"], content["source"], frozenset(content["capabilities"]), options,
                         content["requirements"], content["unavailable"])


def optimizers() -> dict[str, OptimizerInfo]:
    """Returns all known optimizers by name. "multistart:NAME" and plugins ("./libmine.so", "exec:COMMAND") can be used too."""
    return {one["name"]: _make_info(one) for one in json.loads(_armwright.list_optimizers())}


class Scores:
    """The scores that an optimizer gets for k points. All numbers are finite, except that the constraints of failed evaluations are infinite.

    Attributes
    ----------
    objectives : array (k, m)
        A failed evaluation has the penalty of the problem.
    values : array (k,)
        The weighted sum of the objectives.
    constraints : array (k, c)
        The values g. A constraint is met if g is at most 0.
    violations : array (k,)
        The sum of the positive g.
    ok, clipped : array of bool (k,)
        `ok`: the evaluation succeeded. `clipped`: the point was outside the bounds and was evaluated at the nearest point inside.
    residuals : masked array (k, r) or None
        Only for optimizers with the capability "residuals".
    jacobian : masked array (k, r, d) or None
        Only from evaluate_with_jacobian().
    """

    __slots__ = ("objectives", "values", "constraints", "clipped", "residuals", "jacobian", "_status")

    def __init__(self, problem: Description, content: tuple[Any, ...]) -> None:
        objectives, constraints, status, clipped, residuals, jacobian = content
        self.objectives: FloatArray = objectives
        self.values: FloatArray = problem.calc_values(objectives)
        self.constraints: FloatArray = constraints
        self.clipped: npt.NDArray[np.bool_] = clipped
        self.residuals: Optional[MaskedFloats] = None if residuals is None else to_masked(residuals)
        self.jacobian: Optional[MaskedFloats] = None if jacobian is None else to_masked_matrices(jacobian, len(problem))
        self._status: npt.NDArray[np.uint8] = status

    def __len__(self) -> int:
        return len(self.values)

    @property
    def ok(self) -> npt.NDArray[np.bool_]:
        return np.asarray(self._status == 0)

    @property
    def status(self) -> npt.NDArray[np.str_]:
        """The texts of Evaluations.status, and "abandoned" for a candidate that lost a race."""
        return np.array(_armwright.STATUSES)[self._status]

    @property
    def violations(self) -> FloatArray:
        return np.asarray(np.maximum(self.constraints, 0.0).sum(axis=1), dtype=np.float64)


class _Bridge(Protocol):
    """The interface that an Evaluator uses: the library, or the program at the other end of a pipe."""

    @property
    def stopped(self) -> bool: ...

    @property
    def remaining(self) -> int: ...

    def describe_problem(self) -> str: ...

    def evaluate(self, points: FloatArray, with_jacobian: bool, /) -> tuple[Any, ...]: ...

    def begin_generation(self) -> None: ...

    def recommend(self, point: FloatArray, /) -> None: ...

    def explain_end(self, reason: str, /) -> None: ...


class Evaluator:
    """The only access of an optimizer to a problem. It counts the budget, supplies the training cases and records every evaluation.

    Attributes
    ----------
    problem : Description
        The variables with bounds and start, the objectives and the constraints.
    """

    def __init__(self, bridge: _Bridge) -> None:
        self._bridge = bridge
        self.problem = Description(json.loads(bridge.describe_problem()))

    def evaluate(self, X: npt.ArrayLike) -> Scores:
        """Evaluates points (n, d) or (d,), on all cores.

        Returns fewer scores than points if the budget or the time ends or the user interrupts the run. From then on `stopped` is true, and
        every further call returns no scores.
        """
        return Scores(self.problem, self._bridge.evaluate(to_points(X), False))

    def evaluate_with_jacobian(self, X: npt.ArrayLike) -> Scores:
        """Like evaluate(), with exact derivatives of the residuals. Each point is charged 1 + d/4 evaluations, rounded up."""
        return Scores(self.problem, self._bridge.evaluate(to_points(X), True))

    @property
    def stopped(self) -> bool:
        """Whether the run has ended for the optimizer: no further point is evaluated."""
        return self._bridge.stopped

    @property
    def remaining(self) -> int:
        """The number of points that the budget still pays for."""
        return self._bridge.remaining

    def begin_generation(self) -> None:
        """Selects the next training cases. Optimizers with the capability "generations" call it before each generation, also the first."""
        self._bridge.begin_generation()

    def recommend(self, x: npt.ArrayLike) -> None:
        """Names a point (d,) to judge at the end beside the best evaluated points, for example the mean of a distribution.

        It counts also after the budget has ended, until minimize() returns.
        """
        self._bridge.recommend(to_points(x, "x"))


class Optimizer:
    """The base class for your own optimizer. Pass the derived class to optimize(), compare() or serve().

    An optimizer must be deterministic: all its random numbers come from `seed`. Every run makes its own object of the class. If you pass an
    object instead of a class, every run makes a copy of it, and the attributes of the object are recorded with the run.

    Attributes
    ----------
    name : str
        Letters, digits, "_", "-" and "."; results have "python:NAME". Default: the name of the class.
    summary, source : str
        One line that says what the optimizer does (default: the first line of the docstring), and where it comes from.
    capabilities : collection of str
        A subset of CAPABILITIES. "generations": the optimizer calls begin_generation(), so schedules with fresh cases work. "residuals":
        the scores contain residuals. "constraints", "multi_objective": the optimizer uses them. "integer", "categorical": the problem's variables
        keep their types; otherwise they look real (categories: integers), and the points are rounded.
    options : sequence of Option
    requirements : mapping
        The least that a problem must have: "objectives" and "variables" are numbers, "residuals" is true or false.
    settings : dict
        The values of the options by name; available in minimize().

    Examples
    --------
    >>> class RandomSearch(armwright.Optimizer):
    ...     def minimize(self, evaluator, seed):
    ...         random = np.random.default_rng(seed)
    ...         while not evaluator.stopped:
    ...             evaluator.evaluate(evaluator.problem.from_unit(random.random((32, len(evaluator.problem)))))
    """

    name: str = ""
    summary: str = ""
    source: str = ""
    capabilities: ClassVar[Iterable[str]] = ()
    options: ClassVar[Sequence[Option]] = ()
    requirements: ClassVar[Mapping[str, Union[int, bool]]] = {}
    settings: dict[str, OptionValue]

    def minimize(self, evaluator: Evaluator, seed: int) -> Optional[str]:
        """Minimises through the evaluator until it has stopped, or until there is nothing more to try.

        If it returns before the evaluator has stopped, it may return a text that says why. Any other return value is ignored.
        """
        raise NotImplementedError(f"{type(self).__name__} has no minimize(self, evaluator, seed)")


AnyOptimizer = Union[str, Optimizer, type[Optimizer]]


@dataclass(frozen=True)
class PythonOptimizer:
    """A class or an object in the form that the library takes."""

    name: str  # without "python:"
    description: dict[str, Any]
    hashes: dict[str, str]
    make: Callable[[], Optimizer] = field(compare=False)

    def to_row(self) -> tuple[str, str, dict[str, str], Callable[[_Bridge, dict[str, OptionValue], int], None]]:
        return f"python:{self.name}", json.dumps(self.description), self.hashes, self.run

    def run(self, bridge: _Bridge, settings: dict[str, OptionValue], seed: int) -> None:
        optimizer = self.make()
        optimizer.settings = settings
        reason: Any = optimizer.minimize(Evaluator(bridge), seed)
        if isinstance(reason, str):
            bridge.explain_end(reason)


class _Copies:
    """Makes copies of an object, so that no run sees changes by another run."""

    def __init__(self, original: Optimizer) -> None:
        self._original = original

    def __call__(self) -> Optimizer:
        return copy.deepcopy(self._original)


def read_optimizer(optimizer: Union[Optimizer, type[Optimizer]]) -> PythonOptimizer:
    """Checks a class derived from Optimizer, or an object of one. UsageError or BadDataError say what is wrong."""
    cls: type[Optimizer]
    state: Optional[dict[str, Any]]
    make: Callable[[], Optimizer]
    if isinstance(optimizer, type) and issubclass(optimizer, Optimizer):
        cls = optimizer
        state = None
        make = cls
    elif isinstance(optimizer, Optimizer):
        given = optimizer
        cls, state = type(given), vars(given)
        make = _Copies(given)
    else:
        raise UsageError(f"the optimizer is {optimizer!r}; it must be a name (optimizers() has them), a class derived from "
                         "armwright.Optimizer, or an object of one")
    if cls.minimize is Optimizer.minimize:
        raise UsageError(f"{cls.__name__} has no minimize(self, evaluator, seed)")
    name = optimizer.name or cls.__name__
    unknown = sorted(set(cls.capabilities) - set(CAPABILITIES))
    if unknown:
        raise UsageError(f"{cls.__name__} has the capability {unknown[0]!r}; it must be among {', '.join(CAPABILITIES)}")
    description = {
        "type": "description",
        "protocol": 1,
        "name": name,
        "summary": optimizer.summary or first_line_of_doc(cls) or f"The class {cls.__name__}",
        "source": optimizer.source,
        "capabilities": [one for one in CAPABILITIES if one in set(cls.capabilities)],
        "options": [option.describe() for option in cls.options],
    }
    if cls.requirements:
        description["requirements"] = _check_requirements(cls)
    _armwright.check_description(f"python:{name}", json.dumps(description))
    hashes = {f"class {cls.__qualname__}": hash_class(cls)}
    if state:
        hashes[f"attributes of the {cls.__qualname__}"] = _hash(canonical_text(state, f"an attribute of the {cls.__name__}"))
    return PythonOptimizer(name, description, hashes, make)


def _check_requirements(cls: type[Optimizer]) -> dict[str, Union[int, bool]]:
    known = ("objectives", "variables", "residuals")
    for name in cls.requirements:
        if name not in known:
            raise UsageError(f"{cls.__name__} has the requirement {name!r}; it must be among {', '.join(known)}")
    return dict(cls.requirements)


def to_row(optimizer: AnyOptimizer) -> Any:
    """Returns the form that the library takes. A name is returned as it is."""
    return optimizer if isinstance(optimizer, str) else read_optimizer(optimizer).to_row()


@dataclass(frozen=True)
class Finding:
    """The result of one check. `outcome` is "held", "broken" or "exempt" (the promise does not apply); `detail` says how or why."""

    check: str
    promise: str
    outcome: str
    detail: str


def check_optimizer(optimizer: AnyOptimizer, *, options: Optional[Mapping[str, OptionValue]] = None) -> list[Finding]:
    """Checks whether an optimizer keeps the promises of all optimizers, as `armwright check-plugin` does. It takes some seconds.

    The checks use small functions. Some of the promises: the same seed gives the same evaluations, no run influences the next one, any
    budget is accepted, and failing evaluations do not end the run.
    """
    return [Finding(*found) for found in _armwright.check_optimizer(to_row(optimizer), to_options(options))]


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def first_line_of_doc(documented: Any) -> str:
    """Returns the first line of the docstring, "" if there is none."""
    doc = getattr(documented, "__doc__", None)
    return (inspect.cleandoc(doc).splitlines() or [""])[0] if isinstance(doc, str) else ""


def hash_class(cls: type, last: type = Optimizer, without: Sequence[str] = ()) -> str:
    """Returns the SHA-256 of the source text of a class and its base classes, up to `last`; without source text, of the byte code."""
    parts = []
    for one in cls.__mro__:
        if one is last:
            break
        for name, member in sorted(vars(one).items()):
            if name not in without:
                parts.append(f"{one.__qualname__}.{name} {describe_member(member)}")
    return _hash("\n".join(parts))


def describe_member(member: Any) -> str:
    if isinstance(member, (staticmethod, classmethod)):
        member = member.__func__
    if isinstance(member, property):
        return " ".join(describe_member(one) for one in (member.fget, member.fset, member.fdel) if one is not None)
    if isinstance(member, types.FunctionType):
        try:
            return inspect.getsource(member)
        except (OSError, TypeError):  # typed into an interpreter that keeps no source text
            return _describe_code(member.__code__)
    if isinstance(member, type):
        return hash_class(member)
    try:
        return canonical_text(member, "")
    except UsageError:
        return type(member).__name__


def _describe_code(code: types.CodeType) -> str:
    constants = [_describe_code(one) if isinstance(one, types.CodeType) else repr(one) for one in code.co_consts]
    return f"{code.co_code.hex()} {code.co_names} {constants}"


def canonical_text(value: Any, what: str) -> str:
    """Returns a text that is equal for equal plain data. UsageError if a text cannot represent the equality of the value."""
    if value is None or isinstance(value, (bool, int, float, str, bytes, np.generic)):
        return repr(value)
    if isinstance(value, np.ndarray) and value.dtype.kind in "biufcSU":
        return f"{value.dtype} {value.shape} {value.tolist()!r}"
    if isinstance(value, (list, tuple)):
        return "[" + ",".join(canonical_text(one, what) for one in value) + "]"
    if isinstance(value, (set, frozenset)):
        return "{" + ",".join(sorted(canonical_text(one, what) for one in value)) + "}"
    if isinstance(value, dict):
        return "{" + ",".join(f"{key!r}:{canonical_text(value[key], what)}" for key in sorted(value, key=repr)) + "}"
    if isinstance(value, Option):
        return canonical_text(value.describe(), what)
    raise UsageError(f"{what} is a {type(value).__name__}; an object's attributes are recorded with its run, so they must be numbers, texts, "
                     "arrays, or lists and dicts of these: make everything else in minimize()")


def _explain_failure(exception: BaseException) -> tuple[str, list[str]]:
    """Returns one line that says what an optimizer raised and where, and the last lines of its traceback."""
    own = __package__ or "armwright"
    frames = [frame for frame, _ in traceback.walk_tb(exception.__traceback__) if frame.f_globals.get("__package__") != own]
    lines = {id(frame): number for frame, number in traceback.walk_tb(exception.__traceback__)}
    where = ""
    if frames:
        code = frames[-1].f_code
        where = f" ({code.co_filename.rsplit('/', 1)[-1]}, line {lines[id(frames[-1])]}, in {code.co_name})"
    kind = type(exception).__name__
    said = " ".join(str(exception).split())
    text = traceback.format_exception(type(exception), exception, exception.__traceback__)
    shown = [line for block in text for line in block.rstrip("\n").split("\n")][-_LAST_LINES:]
    return f"it raised {kind}{': ' + said if said else ''}{where}", shown
