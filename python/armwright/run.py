"""Runs: one optimizer on one problem. A run can be resumed, and the program can read its folder too."""

from __future__ import annotations

import json
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _armwright
from ._values import FloatArray, MaskedFloats, Settings, to_jobs, to_masked, to_options, to_whole
from .errors import BadDataError, UsageError
from .optimizer import AnyOptimizer, to_row
from .problem import STATUSES, Problem, load_problem
from .progress import Listener, Show
from .user_problem import AnyUserProblem

LARGEST_SEED = 2**63 - 1


@dataclass(frozen=True)
class History:
    """Every training evaluation of a run, read from its journal, in the order of the requests. No number is NaN; missing numbers are masked.

    Attributes
    ----------
    x : array (n, d)
        The points as evaluated, within the bounds.
    objectives : masked array (n, m)
        Masked where the evaluation failed.
    constraints : masked array (n, c)
    case_errors : masked array (n, cases)
    case_numbers : masked array of int (n, cases)
        The numbers of the cases in the training set. A candidate that lost a race has fewer cases.
    index, generation : array of int (n,)
        The position among the evaluations of the run, and the generation (0 if the optimizer has none).
    charge : array of int (n,)
        The cases of the budget that the evaluation cost.
    ok, clipped : array of bool (n,)
    status : array of str (n,)
    """

    x: FloatArray
    objectives: MaskedFloats
    constraints: MaskedFloats
    case_errors: MaskedFloats
    case_numbers: Any
    index: npt.NDArray[np.int64]
    generation: npt.NDArray[np.int64]
    charge: npt.NDArray[np.int64]
    ok: npt.NDArray[np.bool_]
    status: npt.NDArray[np.str_]
    clipped: npt.NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.x)


def _read_history(folder: Path) -> History:
    if not (folder / "journal").is_file():
        raise UsageError(f"{folder}: holds no journal, so it is not the folder of a run")
    x, objectives, constraints, errors, numbers, index, generation, charge, status, clipped = _armwright.read_history(str(folder))
    values, mask = numbers
    return History(
        x=x[0],
        objectives=to_masked(objectives),
        constraints=to_masked(constraints),
        case_errors=to_masked(errors),
        case_numbers=np.ma.MaskedArray(np.where(mask, -1, values).astype(np.int64), mask=mask),  # type: ignore[no-untyped-call]
        index=index.astype(np.int64),
        generation=generation.astype(np.int64),
        charge=charge.astype(np.int64),
        ok=status == 0,
        status=np.array(STATUSES)[status],
        clipped=clipped != 0,
    )


class Run:
    """The result of a run, as recorded in its folder.

    Attributes
    ----------
    folder : Path
        The folder of the run, for `armwright show`, `report` and `export`.
    finished : bool
        False if the run was stopped. It then has a history but no result, and the same call continues it.
    problem, optimizer : str
    seed : int
    x : array (d,) or None
        The winner: the design with the best validation result of those that were good in training. None if there is none.
    value : float or None
        The objective of the winner on the test set (the weighted sum if there are several).
    test : dict or None
        The evaluation of the winner on the test set: objectives, constraint_values, metrics, case_errors, ...
    summary : dict or None
        Statistics of the errors of the winner on the test set: mean, median, percentile_95, worst, failures, cases, without_number.
    candidates : list of dict
        The designs that were judged on the validation set: x, evaluation, generation, training_objective, validation.
    counts : dict
        evaluations, cases, failed, clipped, feasible, generations.
    end_reason : str
        "budget", "optimizer finished" or "optimizer failed".
    choice : str
        Which optimizer `auto` chose and why, in two sentences; "" for other optimizers.
    end_detail : str
        Why the optimizer finished, in its own words; "" if it did not say.
    unused_evaluations : int
        The evaluations that the budget would still have paid for when the optimizer finished.
    failure : str
        The way in which the optimizer failed; "" if it did not.
    """

    def __init__(self, folder: Path, content: Optional[dict[str, Any]], manifest: dict[str, Any]) -> None:
        self.folder = folder
        self.finished = content is not None
        self._content = content
        self._manifest = manifest
        self._history: Optional[History] = None
        recorded = manifest["configuration"]["run"]
        self.optimizer: str = recorded["optimizer"]
        self.seed: int = recorded["seed"]
        self.budget: int = recorded["budget"]
        result: dict[str, Any] = content or {}
        self.problem: str = result.get("problem", manifest["configuration"]["problem"].get("name", ""))
        self.candidates: list[dict[str, Any]] = result.get("candidates", [])
        self.counts: dict[str, int] = result.get("counts", {})
        self.end_reason: str = result.get("end_reason", "")
        self.choice: str = result.get("choice", "")
        self.end_detail: str = result.get("end_detail", "")
        self.unused_evaluations: int = result.get("unused_evaluations", 0)
        self.failure: str = result.get("failure", "")
        winner: dict[str, Any] = result.get("winner") or {}
        self.x: Optional[FloatArray] = np.array(self.candidates[winner["candidate"]]["x"]) if winner else None
        self.test: Optional[dict[str, Any]] = winner.get("test")
        self.summary: Optional[dict[str, Any]] = winner.get("test_summary")
        self.value: Optional[float] = None
        if self.test is not None and self.test["objectives"]:
            weights = result["objective_weights"] or [1.0]
            self.value = sum(weight * one for weight, one in zip(weights, self.test["objectives"]))

    def __repr__(self) -> str:
        state = f"value {self.value:.6g} on the test set" if self.value is not None else self.end_reason or "not finished"
        return f"<armwright.Run {self.folder}: {self.optimizer}, seed {self.seed}, {state}>"

    @property
    def history(self) -> History:
        """Every training evaluation. The first access reads them from the journal."""
        if self._history is None:
            self._history = _read_history(self.folder)
        return self._history

    def importance(self, simulations: Optional[int] = None, *, jobs: Optional[int] = None, progress: Show = None) -> dict[str, Any]:
        """Which variables matter: Sobol indices of a model of the recorded evaluations, near the winner and over the whole run.

        Parameters
        ----------
        simulations : int, optional
            Up to this many test cases of designs around the winner are simulated. Their indices need no model. By default nothing is simulated.
        jobs, progress : optional
            As in `optimize`.

        Returns
        -------
        dict
            The output of `armwright show --importance --json`. `parts` has one entry per region, "winner", "run" and "design", with the share
            of the differences that the model explains (`explained`, cross-validated), what that means (`judgement`), and per variable the
            indices `first` (alone) and `total` (with others), each with a 95 % interval.
        """
        number = None if simulations is None else to_whole("simulations", simulations, 10**9)
        with Listener(progress) as listener:
            content: dict[str, Any] = json.loads(_armwright.importance(str(self.folder), number, to_jobs(jobs), listener))
        return content

    @property
    def identification(self) -> Optional[dict[str, Any]]:
        """What identify() found, as identification.json has it; None if the run is of another kind or not finished.

        `doubts` comes first. `parameters` is a list of dicts with name, unit, before, start, value, standard_error, lower and upper (the 95 %
        interval), determined and at_bound. `undetermined` says in words what the motion cannot tell, `correlations` which estimates depend on
        each other. `fitted` and `held_back` (if there are such logs) have logs, error_before, error_after, and per joint rms_before,
        rms_after, deviation, whiteness_p and independent_s. `motions` has the recorded and modelled efforts of each log.
        """
        file = self.folder / "identification.json"
        if not self.finished or not file.is_file():
            return None
        content: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        return content

    @property
    def manifest(self) -> dict[str, Any]:
        """The request and the program that made the run: configuration, build, command line, time."""
        return self._manifest

    def to_dict(self) -> dict[str, Any]:
        """Returns the content of result.json. UsageError if the run is not finished."""
        if self._content is None:
            raise UsageError(f"{self.folder}: this run is not finished; the same call continues it")
        copy: dict[str, Any] = json.loads(json.dumps(self._content))
        return copy


def load_run(folder: Union[str, Path]) -> Run:
    """Reads the folder of a run that this package or the program made, finished or not."""
    path = Path(folder)
    file = path / "manifest.json"
    if not file.is_file():
        raise UsageError(f"{path}: is not the folder of a run (it has no manifest.json)")
    try:
        manifest = json.loads(file.read_text(encoding="utf-8"))
        is_finished = (path / "result.json").is_file()
        return Run(path, json.loads(_armwright.load_result(str(path))) if is_finished else None, manifest)
    except (KeyError, TypeError, json.JSONDecodeError, UnicodeDecodeError) as error:
        raise BadDataError(f"{file}: is not a manifest that armwright wrote ({error!r})") from None


def own_command() -> list[str]:
    """Returns the command that runs this script again, for runs that no command of the program can continue."""
    main = sys.modules.get("__main__")
    script = getattr(main, "__file__", None)
    return [sys.executable, os.path.abspath(script)] if script else ["#", "the same call in Python, or in the notebook"]


def _make_command(problem: Problem, optimizer: AnyOptimizer, settings: dict[str, Optional[str]], options: list[str]) -> list[str]:
    """Returns the command that continues the run. The program can do this if neither optimizer nor problem is a class."""
    if not isinstance(optimizer, str) or problem._inner.is_python:
        return own_command()
    words = ["armwright", "optimize", problem._inner.asked_name, "--optimizer", optimizer]
    for setting in problem._inner.settings:
        words += ["--set", setting]
    for option in options:
        words += ["--opt", option]
    for flag, value in settings.items():
        if value is not None:
            words += [flag, value]
    return words


def optimize(
    problem: Union[Problem, AnyUserProblem, str, Path],
    optimizer: Optional[AnyOptimizer] = None,
    *,
    seed: int = 1,
    budget: Optional[int] = None,
    options: Optional[Mapping[str, Any]] = None,
    schedule: Optional[str] = None,
    racing: Optional[str] = None,
    set: Optional[Settings] = None,
    out: Union[None, str, Path] = None,
    new: bool = False,
    jobs: Optional[int] = None,
    time_limit_s: Optional[float] = None,
    progress: Show = None,
) -> Run:
    """Runs an optimizer on a problem, as `armwright optimize` does: with the same folder, journal, judging and result, bit for bit.

    If Ctrl-C, a time limit or a crash interrupts the run, the same call continues it. If the run is complete, the call only reads it.

    Parameters
    ----------
    problem : Problem, UserProblem, class derived from it, str or path
        The problem, or its name; with a class or a name, `set` may change its settings.
    optimizer : str, Optimizer, or class derived from it, optional
        Default: the optimizer of the problem.
    seed : int
        The seed of the random numbers of the optimizer. Nothing else uses it.
    budget : int, optional
        The number of training cases to simulate. Default: the budget of the problem.
    options : mapping, optional
        Options of the optimizer, for example {"population": 50}.
    schedule : str, optional
        The schedule of training cases: "fixed:K", "fresh:K" or "coevolution:K".
    racing : str, optional
        "none", "halving:FIRST_CASES:ETA" or "abandonment:MARGIN:CHUNK_CASES".
    out : str or path, optional
        The folder of the run. Default: results/PROBLEM-OPTIMIZER-seedN and what was set, in the current folder, as with the program.
    new : bool
        Makes another run beside an existing one, in FOLDER-002, FOLDER-003, ...
    jobs : int, optional
        The number of threads. The result does not depend on it. Default: $ARMWRIGHT_JOBS or all cores.
    time_limit_s : float, optional
        Stops the run after this time. The returned Run is then not `finished`, and the same call continues it.
    progress : optional
        None or True: progress is shown in a notebook and on a terminal only. False: no progress is shown. A callable is called with a
        Progress from time to time, on the calling thread. An exception of the callable stops the run; the same call continues it.

    Raises
    ------
    KeyboardInterrupt
        After Ctrl-C. The message says how to continue the run.
    UsageError, BadDataError, BusyError, IoError
        With the messages of the program.
    """
    if not isinstance(problem, Problem):
        problem = load_problem(problem, set=set)
    elif set is not None:
        raise UsageError("set applies only to a problem that is given by its name; for a loaded problem use load_problem(..., set=...)")
    chosen: AnyOptimizer = problem.optimizer if optimizer is None else optimizer
    row = to_row(chosen)
    texts = to_options(options)
    seed = to_whole("seed", seed, LARGEST_SEED)
    command = _make_command(problem, chosen, {"--seed": str(seed), "--budget": None if budget is None else str(budget),
                                              "--schedule": schedule, "--racing": racing}, texts)
    with Listener(progress) as listener:
        for note in problem._inner.check_paths():
            listener("warning: " + note, None)
        try:
            folder, _ = _armwright.optimize(problem._inner, row, texts, seed, budget, schedule, racing, None if out is None else str(out), new,
                                            to_jobs(jobs), time_limit_s, command, listener)
        except KeyboardInterrupt:
            raise KeyboardInterrupt("interrupted; all evaluations so far are recorded, and the same call of armwright.optimize() goes on "
                                    "from there" + (" (without new=True, and out= its folder)" if new else "")) from None
    return load_run(folder)
