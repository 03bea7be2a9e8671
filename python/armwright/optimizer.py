"""Optimizers: those that there are, and the class to derive your own from."""

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
from .problem import STATUSES

OptionValue = Union[bool, int, float, str]
CAPABILITIES = ("bounds", "constraints", "multi_objective", "batch", "noisy", "residuals", "stochastic", "generations", "local", "sampling",
                "paced")
_LARGEST_INTEGER = 2**53  # up to which doubles tell integers apart
_LARGEST_NUMBER = 1e300
_LAST_LINES = 10  # of a traceback


@dataclass(frozen=True)
class Option:
    """An option of an optimizer's. The default's type is the option's: bool, int, float or str.

    `lower` and `upper` are the closed range allowed of numbers, `choices` the texts allowed (none: any).
    """

    name: str
    default: OptionValue
    description: str = ""
    lower: Optional[float] = None
    upper: Optional[float] = None
    choices: Sequence[str] = ()

    def describe(self) -> dict[str, Any]:
        """As the plugin protocol has it."""
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
    """An optimizer that there is: `capabilities` is a subset of CAPABILITIES; `unavailable` says why it cannot be used here ("" if it can)."""

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
    """The optimizers that there are, by name. Besides there are "multistart:NAME" and plugins: "./libmine.so", "exec:COMMAND"."""
    return {one["name"]: _make_info(one) for one in json.loads(_armwright.list_optimizers())}


class Scores:
    """What an optimizer learns of k points; always finite but for the constraints of failed evaluations, which are infinite.

    Attributes
    ----------
    objectives : array (k, m)
        Of a failed evaluation the problem's penalty.
    values : array (k,)
        Their weighted sum.
    constraints : array (k, c)
        g, met where at most 0.
    violations : array (k,)
        The sum of what of them is above 0.
    ok, clipped : array of bool (k,)
        Whether the evaluation succeeded; whether the point lay outside the bounds and was evaluated at the nearest one inside.
    residuals : masked array (k, r) or None
        Of optimizers with the capability "residuals".
    jacobian : masked array (k, r, d) or None
        Of evaluate_with_jacobian().
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
        """Texts as in Evaluations, and "abandoned" of who has lost a race."""
        return np.array(STATUSES)[self._status]

    @property
    def violations(self) -> FloatArray:
        return np.asarray(np.maximum(self.constraints, 0.0).sum(axis=1), dtype=np.float64)


class _Bridge(Protocol):
    """What is behind an Evaluator: the library, or the program at the other end of a pipe."""

    @property
    def stopped(self) -> bool: ...

    @property
    def remaining(self) -> int: ...

    def describe_problem(self) -> str: ...

    def evaluate(self, points: FloatArray, with_jacobian: bool, /) -> tuple[Any, ...]: ...

    def begin_generation(self) -> None: ...

    def recommend(self, point: FloatArray, /) -> None: ...


class Evaluator:
    """The only door from an optimizer to a problem: counts the budget, supplies the training cases, records every evaluation.

    Attributes
    ----------
    problem : Description
        Variables with bounds and start, objectives, constraints.
    """

    def __init__(self, bridge: _Bridge) -> None:
        self._bridge = bridge
        self.problem = Description(json.loads(bridge.describe_problem()))

    def evaluate(self, X: npt.ArrayLike) -> Scores:
        """Evaluates points (n, d) or (d,), on all cores.

        Fewer scores than points come back where budget, time or the user's patience end; from then on `stopped` holds, and every
        further call is answered with none.
        """
        return Scores(self.problem, self._bridge.evaluate(to_points(X), False))

    def evaluate_with_jacobian(self, X: npt.ArrayLike) -> Scores:
        """The same with exact derivatives of the residuals, each charged 1 + d/4 evaluations, rounded up."""
        return Scores(self.problem, self._bridge.evaluate(to_points(X), True))

    @property
    def stopped(self) -> bool:
        """Whether it is over."""
        return self._bridge.stopped

    @property
    def remaining(self) -> int:
        """How many more points the budget allows."""
        return self._bridge.remaining

    def begin_generation(self) -> None:
        """Before each generation, the first included, of optimizers with the capability "generations": the next training cases."""
        self._bridge.begin_generation()

    def recommend(self, x: npt.ArrayLike) -> None:
        """Names a point (d,) worth judging at the end beside the best evaluated ones: a distribution's mean, say."""
        self._bridge.recommend(to_points(x, "x"))


class Optimizer:
    """Derive your own optimizer from this, and pass the class to optimize(), compare() or serve().

    It must be deterministic: all chance comes from `seed`. For every run an object is made of the class; of an object that you pass
    instead, a copy, and its attributes are recorded with the run.

    Attributes
    ----------
    name : str
        Letters, digits, "_", "-" and "."; results say "python:NAME". Default: the class's name.
    summary, source : str
        One line on what it does (default: the docstring's first), and where it comes from.
    capabilities : collection of str
        Of CAPABILITIES. "generations": it calls begin_generation(), so that a schedule with fresh cases can serve it. "residuals":
        scores carry them. "constraints", "multi_objective": it uses these.
    options : sequence of Option
    settings : dict
        The options' values by name, in minimize().

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
    settings: dict[str, OptionValue]

    def minimize(self, evaluator: Evaluator, seed: int) -> None:
        """Minimises through the evaluator until it has stopped, or there is nothing more to try. What it returns nobody looks at."""
        raise NotImplementedError(f"{type(self).__name__} has no minimize(self, evaluator, seed)")


AnyOptimizer = Union[str, Optimizer, type[Optimizer]]


@dataclass(frozen=True)
class PythonOptimizer:
    """A class or an object as the library takes it."""

    name: str  # without "python:"
    description: dict[str, Any]
    hashes: dict[str, str]
    make: Callable[[], Optimizer] = field(compare=False)

    def to_row(self) -> tuple[str, str, dict[str, str], Callable[[_Bridge, dict[str, OptionValue], int], None]]:
        return f"python:{self.name}", json.dumps(self.description), self.hashes, self.run

    def run(self, bridge: _Bridge, settings: dict[str, OptionValue], seed: int) -> None:
        optimizer = self.make()
        optimizer.settings = settings
        optimizer.minimize(Evaluator(bridge), seed)


class _Copies:
    """Makes copies of an object, so that no run sees what another has left in it."""

    def __init__(self, original: Optimizer) -> None:
        self._original = original

    def __call__(self) -> Optimizer:
        return copy.deepcopy(self._original)


def read_optimizer(optimizer: Union[Optimizer, type[Optimizer]]) -> PythonOptimizer:
    """Checks a class or an object of one. UsageError or BadDataError say what does not hold together."""
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
    doc = (inspect.cleandoc(cls.__doc__).splitlines() or [""])[0] if cls.__doc__ else ""
    description = {
        "type": "description",
        "protocol": 1,
        "name": name,
        "summary": optimizer.summary or doc or f"The class {cls.__name__}",
        "source": optimizer.source,
        "capabilities": [one for one in CAPABILITIES if one in set(cls.capabilities)],
        "options": [option.describe() for option in cls.options],
    }
    _armwright.check_description(f"python:{name}", json.dumps(description))
    hashes = {f"class {cls.__qualname__}": hash_class(cls)}
    if state:
        hashes[f"attributes of the {cls.__qualname__}"] = _hash(canonical_text(state, f"an attribute of the {cls.__name__}"))
    return PythonOptimizer(name, description, hashes, make)


def to_row(optimizer: AnyOptimizer) -> Any:
    """What the library takes: a name as it is."""
    return optimizer if isinstance(optimizer, str) else read_optimizer(optimizer).to_row()


@dataclass(frozen=True)
class Finding:
    """Whether a promise is "held", "broken" or does not apply ("exempt"); how it is broken, or why it does not apply."""

    check: str
    promise: str
    outcome: str
    detail: str


def check_optimizer(optimizer: AnyOptimizer, *, options: Optional[Mapping[str, OptionValue]] = None) -> list[Finding]:
    """Tries whether an optimizer keeps what every optimizer promises, as `armwright check-plugin` does: in some seconds, on small functions.

    Same seed, same evaluations; nothing kept from one run for the next; content with any budget; failing evaluations survived; and more.
    """
    return [Finding(*found) for found in _armwright.check_optimizer(to_row(optimizer), to_options(options))]


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def hash_class(cls: type) -> str:
    """SHA-256 of the source text of a class and those it is derived from, up to Optimizer; of the byte code where there is no text."""
    parts = []
    for one in cls.__mro__:
        if one is Optimizer:
            break
        for name, member in sorted(vars(one).items()):
            parts.append(f"{one.__qualname__}.{name} {_describe_member(member)}")
    return _hash("\n".join(parts))


def _describe_member(member: Any) -> str:
    if isinstance(member, (staticmethod, classmethod)):
        member = member.__func__
    if isinstance(member, property):
        return " ".join(_describe_member(one) for one in (member.fget, member.fset, member.fdel) if one is not None)
    if isinstance(member, types.FunctionType):
        try:
            return inspect.getsource(member)
        except (OSError, TypeError):  # typed into an interpreter that keeps no text
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
    """Equal for equal plain data; UsageError for anything whose equality a text cannot tell."""
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
    """What an optimizer has raised and where, in one line; and the last lines of its traceback."""
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
