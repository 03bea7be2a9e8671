"""Problems: their descriptions, and the evaluation of points and designs on them."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Optional, Sequence, Union, cast

import numpy as np
import numpy.typing as npt

from . import _armwright
from ._values import (FloatArray, MaskedFloats, Settings, quote_words, to_jobs, to_list, to_masked, to_masked_matrices, to_points,
                      to_settings, to_whole)
from .description import Description
from .errors import UsageError
from .progress import Listener, Show
from .user_problem import AnyUserProblem, PythonProblem, UserProblem, enter_worker, is_user_problem

STATUSES: tuple[str, ...] = _armwright.STATUSES
_MOST_CASES = 1_000_000
_ROLES = ("training", "validation", "test")


@dataclass(frozen=True)
class Evaluations:
    """The results of n evaluations. No number in them is ever NaN.

    An evaluation that failed has a status. Its objectives are those that optimizers get: the penalty of the problem, which is finite and worse
    than the value of any design that works. Its constraints are infinite. All its other numbers that do not exist are masked.

    Attributes
    ----------
    objectives : array (n, m)
        The values to minimise, in their units.
    values : array (n,)
        The weighted sum of the objectives; with a single objective, the objective itself.
    constraints : array (n, c)
        The values g. A constraint is met if g is at most 0.
    metrics : dict of str to masked array (n,)
        By name, in their units.
    case_errors : masked array (n, cases)
        The error on every test case (in metres for arms).
    ok : array of bool (n,)
        Whether the evaluation succeeded.
    status : array of str (n,)
        "ok", "diverged", "unreachable", "timed_out" or "failed".
    reasons : dict of int to str
        The reasons of the evaluations that failed, by row.
    residuals : masked array (n, r) or None
        Only on request. The sum of their squares is the objective, or its exponential.
    jacobian : masked array (n, r, d) or None
        Only on request: the exact derivatives of the residuals.
    """

    objectives: FloatArray
    values: FloatArray
    constraints: FloatArray
    metrics: dict[str, MaskedFloats]
    case_errors: MaskedFloats
    ok: npt.NDArray[np.bool_]
    status: npt.NDArray[np.str_]
    reasons: dict[int, str]
    residuals: Optional[MaskedFloats] = None
    jacobian: Optional[MaskedFloats] = None

    def __len__(self) -> int:
        return len(self.values)

    def __repr__(self) -> str:
        best = f", smallest value {self.values.min():.6g}" if len(self) > 0 else ""
        return f"<armwright.Evaluations: {int(self.ok.sum())} of {len(self)} ok{best}>"


@dataclass(frozen=True)
class DesignEvaluation:
    """The results of one design of an arm on test cases, with the numbers of `armwright evaluate --json`.

    Attributes
    ----------
    summary : dict
        mean_error_m, median_error_m, percentile_95_error_m, worst_error_m, failures, without_number, error_while_moving_rms_m,
        error_while_moving_peak_m, error_after_start_up_m, total_torque_n_m, mean_energy_j, cases, design, problem, test_set; total_force_n
        if a joint slides. The errors in motion are missing if no case has a number. A number that does not exist is None.
    errors_m : masked array (cases,)
        A case without a number is masked.
    energies_j : masked array (cases,)
    point_errors_m : masked array (cases, points)
    status : list of str
        "ok", "diverged" or "unreachable", one per case.
    reasons : list of str
        The reason why a case has no number; "" if it has one.
    requirements : list of dict
        Only for problems with requirements: name, unit, limit, value, grade ("met", "tight", "missed", "unknown").
    """

    summary: dict[str, Any]
    errors_m: MaskedFloats
    energies_j: MaskedFloats
    point_errors_m: MaskedFloats
    status: list[str]
    reasons: list[str]
    requirements: list[dict[str, Any]] = field(default_factory=list)

    def __repr__(self) -> str:
        of = self.summary
        mean = "no mean error" if of["mean_error_m"] is None else f"mean error {of['mean_error_m'] * 1000:.6g} mm"
        return (f"<armwright.DesignEvaluation {of['design']} on {of['problem']}, {of['test_set']}: {mean}, "
                f"{of['failures']} of {of['cases']} cases failed>")

    def to_dict(self) -> dict[str, Any]:
        """Returns everything as plain lists and numbers, ready for JSON. A number that does not exist is None."""
        return {
            "summary": dict(self.summary),
            "errors_m": to_list(self.errors_m),
            "energies_j": to_list(self.energies_j),
            "point_errors_m": to_list(self.point_errors_m),
            "status": list(self.status),
            "reasons": list(self.reasons),
            "requirements": list(self.requirements),
        }


class Problem(Description):
    """A problem that can be evaluated. load_problem() makes one. It has the attributes of a Description, and these:

    Attributes
    ----------
    title : str
    is_arm : bool
        True if a decision vector is the design of an arm; false if the problem is a function.
    sets : dict
        The names of the sets "training", "validation" and "test", and the numbers of cases of the last two.
    budget : int
        The default number of training cases that a run simulates.
    optimizer : str
        The default optimizer.
    schedule : str
        The default schedule, which says on which cases a run trains.
    published : dict
        The values that the source of the problem reports for its own winner.
    configuration : dict
        All settings, after inheritance and `set`.
    """

    def __init__(self, inner: _armwright.Problem) -> None:
        super().__init__(json.loads(inner.describe()))
        self._inner = inner
        content = self._content
        self.title: str = content["title"]
        self.is_arm: bool = content["is_arm"]
        self.sets: dict[str, Any] = content["sets"]
        self.budget: int = content["budget"]
        self.optimizer: str = content["optimizer"]
        self.schedule: str = content["schedule"]
        self.published: dict[str, Any] = content["published"]
        self.configuration: dict[str, Any] = content["configuration"]

    def __repr__(self) -> str:
        return f"<armwright.Problem {self.name}: {len(self.variables)} variables, {self.title}>"

    def to_dict(self) -> dict[str, Any]:
        """Returns all data of the problem as plain lists and numbers."""
        copy: dict[str, Any] = json.loads(json.dumps(self._content))
        return copy

    def evaluate(
        self,
        X: npt.ArrayLike,
        *,
        cases: Union[None, int, Sequence[int]] = None,
        set: str = "training",
        residuals: bool = False,
        jacobian: bool = False,
        jobs: Optional[int] = None,
        progress: Show = None,
    ) -> Evaluations:
        """Evaluates points on test cases, on all cores. It counts no budget, records nothing and chooses no winner.

        Parameters
        ----------
        X : array (n, d) or (d,)
            Points within the bounds, in the units of the variables. An array of doubles in C order is not copied.
        cases : int or sequence of int, optional
            The number of cases, counted from the first of the set, or the numbers of the cases. Default: the number of cases on which the
            problem trains with fixed cases, validates or tests.
        set : str
            "training", "validation" or "test" for the sets of the problem, or a name such as "train/7" or "test/3": any name generates cases.
            A training case is cut off at an error of 1 m. Other cases are never cut off.
        residuals, jacobian : bool
            Whether the result contains them.
        jobs : int, optional
            The number of threads. Results do not depend on it. Default: $ARMWRIGHT_JOBS or all cores.
        progress : optional
            As in optimize().

        Raises
        ------
        UsageError
            For a wrong shape, a value that is no number, a point out of bounds (clip() moves it), or derivatives that the problem lacks.
        """
        points = to_points(X)
        role, name = self._find_set(set)
        for wanted, has, what in ((residuals, self.has_residuals, "residuals"), (jacobian, self.has_jacobian, "jacobian")):
            if wanted and not has:
                raise UsageError(f"problem {self.name} has no {what}: {self._content[what + '_advice'] or 'it offers none'}")
        with Listener(progress) as listener:
            table, reasons, rest, slopes = self._inner.evaluate(
                points, role, name, self._list_numbers(cases, role), residuals, jacobian, to_jobs(jobs), listener)
        objectives, constraints, metrics, case_errors, status = table
        return Evaluations(
            objectives=objectives,
            values=self.calc_values(objectives),
            constraints=constraints,
            metrics={one.name: to_masked((metrics[:, i], np.isinf(metrics[:, i]))) for i, one in enumerate(self.metrics)},
            case_errors=to_masked((case_errors, np.isinf(case_errors))),
            ok=status == 0,
            status=np.array(STATUSES)[status],
            reasons=reasons,
            residuals=None if rest is None else to_masked(rest),
            jacobian=None if slopes is None else to_masked_matrices(slopes, len(self)),
        )

    def cases(self, set: str = "test", count: Optional[int] = None, *, first: int = 0) -> FloatArray:
        """Returns test cases of a set: (cases, points, 3), x, y, z in metres in the base frame of the robot. The first point is the start.

        They are those of `armwright testset export`. `set` is as in evaluate(). The default `count` is the number of cases of the problem.
        """
        role, name = self._find_set(set)
        numbers = self._list_numbers(count, role)
        return self._inner.cases(name, to_whole("first", first, 2**53), len(numbers))

    def evaluate_design(
        self,
        design: Union[str, Path, npt.ArrayLike],
        *,
        cases: Union[None, int, npt.ArrayLike, Sequence[npt.ArrayLike]] = None,
        set: str = "test",
        jobs: Optional[int] = None,
        progress: Show = None,
    ) -> DesignEvaluation:
        """Judges one design of an arm on every case, without any cut-off, as `armwright evaluate` does.

        Parameters
        ----------
        design : str, path or array (d,)
            A shipped design ("table-a10"), a design file, "start", or a point.
        cases : int or array (cases, points, 3), optional
            The number of cases, counted from the first of the set (default: the number of test cases of the problem). Or cases of your own
            in metres, where the first point is the start; a list of arrays if their lengths differ.
        set : str
            As in evaluate().
        jobs, progress : optional
            As in evaluate().
        """
        role, name = self._find_set(set)
        chosen: Union[str, list[FloatArray]] = name
        if cases is None or isinstance(cases, (int, np.integer)):
            count = len(self._list_numbers(None if cases is None else int(cases), role))
        else:
            own: Any = cases
            chosen = [to_points(one, "cases") for one in own]
            count = len(chosen)
        asked: Union[str, FloatArray] = str(design) if isinstance(design, (str, Path)) else to_points(design, "x")
        with Listener(progress) as listener:
            text, status, reasons, errors, energies, points = _armwright.evaluate_design(
                self._inner, asked, chosen, count, to_jobs(jobs), listener)
        content = json.loads(text)
        return DesignEvaluation(
            summary=content["summary"],
            errors_m=to_masked(errors)[0],
            energies_j=to_masked(energies)[0],
            point_errors_m=to_masked(points),
            status=status,
            reasons=reasons,
            requirements=content["requirements"],
        )

    def write_design(self, x: npt.ArrayLike, path: Union[str, Path], *, name: Optional[str] = None) -> Path:
        """Writes a point (d,) as a design file, for example for `armwright evaluate PATH`. Returns the path."""
        file = Path(path)
        file.write_text(_armwright.design_toml(self._inner, to_points(x, "x"), name or file.stem), encoding="utf-8")
        return file

    def _find_set(self, name: str) -> tuple[str, str]:
        """Returns the role and the name of a set."""
        if name in _ROLES:
            return name, self.sets[name]
        if "/" not in name:
            raise UsageError(f"set is {name!r}; it must be training, validation, test, or a name with a slash such as test/3")
        return {"train": "training", "validation": "validation"}.get(name.split("/")[0], "test"), name

    def _list_numbers(self, cases: Union[None, int, Sequence[int]], role: str) -> list[int]:
        if cases is None:
            cases = self._count_training_cases() if role == "training" else self.sets[role + "_cases"]
        if isinstance(cases, (int, np.integer)):
            if not 1 <= cases <= _MOST_CASES:
                raise UsageError(f"cases is {cases}; it must be an integer from 1 to {_MOST_CASES}, or a list of numbers of cases")
            return list(range(int(cases)))
        numbers = [to_whole("a case's number", one, 2**53) for one in cases]
        if not numbers:
            raise UsageError("cases is empty; it must name at least one")
        return numbers

    def _count_training_cases(self) -> int:
        kind, count = self.schedule.split(":")
        return int(count) if kind == "fixed" else int(self._content["fixed_cases"])


def _load_own(problem: AnyUserProblem, settings: list[str]) -> Problem:
    own = PythonProblem(problem)
    time_limit_s, memory_mib = float(own.problem.time_limit_s), float(own.problem.memory_mib)
    limits = {"program.time_limit_s": (time_limit_s, UserProblem.time_limit_s), "program.memory_mib": (memory_mib, UserProblem.memory_mib)}
    changed = [f"{key}={value!r}" for key, (value, usual) in limits.items() if value != usual]
    return Problem(_armwright.load_python_problem(own.full_name, own.text, own.answer, enter_worker, time_limit_s, memory_mib,
                                                  bool(own.problem.isolate), own.is_batched, changed + settings))


def load_problem(
    name: Union[None, str, Path, AnyUserProblem] = None,
    *,
    set: Optional[Settings] = None,
    robot: Union[None, str, Path] = None,
    base: Optional[str] = None,
    tip: Optional[str] = None,
    plant: Union[None, str, Path] = None,
) -> Problem:
    """Loads a problem.

    Parameters
    ----------
    name : str, path, UserProblem or class derived from it, optional
        A shipped problem (list_problems()), a TOML file, or a problem of your own. With `robot`, the default is the problem for any arm, "robot".
    set : mapping or list of str, optional
        Settings to change, as with --set of the program: {"physics.engine": "articulated", "task.load_kg": 20}, or KEY=VALUE texts.
    robot, base, tip : str, optional
        An arm of your own: its URDF (or the name of a shipped robot), and the links at which it begins and ends.
    plant : str or path, optional
        The file of the robot's plant, such as the plant.toml that identify() writes.

    Examples
    --------
    >>> problem = armwright.load_problem("q1-complex", set={"physics.engine": "articulated"})
    >>> problem.evaluate(problem.start, cases=5).values.shape
    (1,)
    """
    settings = to_settings(set)
    if is_user_problem(name):
        if not robot is base is tip is plant is None:
            raise UsageError("robot, base, tip and plant describe an arm; a problem of your own has none")
        return _load_own(cast(AnyUserProblem, name), settings)
    for key, kind, file in (("urdf", "robots", robot), ("plant", "plants", plant)):
        if file is not None:
            settings.append(f"robot.{key}={quote_words(str(Path(_armwright.resolve_config(kind, str(file))).absolute()))}")
    for key, link in (("base", base), ("tip", tip)):
        if link is not None:
            settings.append(f"robot.{key}={quote_words(link)}")
    if name is None and robot is None:
        raise UsageError("a problem's name is missing; list_problems() has the shipped ones, or give an arm of your own: robot=FILE")
    return Problem(_armwright.Problem(str(name) if name is not None else "robot", settings))


def list_problems() -> dict[str, str]:
    """Returns the titles of the shipped problems by name."""
    return dict(_armwright.list_problems())


def list_designs() -> list[str]:
    """Returns the names of the shipped designs, published ones and ours."""
    return list(_armwright.list_configs("designs"))
