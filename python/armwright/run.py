"""Runs: one optimizer on one problem, resumable, in a folder that the program reads, too."""

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

_LARGEST_SEED = 2**63 - 1


@dataclass(frozen=True)
class History:
    """Every training evaluation of a run, in the order asked for, from its journal. No number is NaN; what is not there is masked.

    Attributes
    ----------
    x : array (n, d)
        As evaluated, within the bounds.
    objectives : masked array (n, m)
        Masked where the evaluation failed.
    constraints : masked array (n, c)
    case_errors : masked array (n, cases)
    case_numbers : masked array of int (n, cases)
        On which cases of the training set. Of who lost a race there are fewer.
    index, generation : array of int (n,)
        Place among the run's evaluations, and generation (0 without).
    charge : array of int (n,)
        In cases of the budget.
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
    """A run's result, as recorded in its folder.

    Attributes
    ----------
    folder : Path
        `armwright show`, `report` and `export` read it.
    finished : bool
        False: the run was stopped; the same call goes on. Then there is a history, and no result yet.
    problem, optimizer : str
    seed : int
    x : array (d,) or None
        The winner: of the designs that were good in training the best on the validation set. None if there is none.
    value : float or None
        Its objective on the test set (of several the weighted sum).
    test : dict or None
        Its evaluation on the test set: objectives, constraint_values, metrics, case_errors, ...
    summary : dict or None
        Of its errors on the test set: mean, median, percentile_95, worst, failures, cases, without_number.
    candidates : list of dict
        The designs that were judged on the validation set: x, evaluation, generation, training_objective, validation.
    counts : dict
        evaluations, cases, failed, clipped, feasible, generations.
    end_reason : str
        "budget", "optimizer finished" or "optimizer failed".
    failure : str
        How the optimizer failed; "" if it did not.
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
        """Every training evaluation; read from the journal once, when first asked for."""
        if self._history is None:
            self._history = _read_history(self.folder)
        return self._history

    @property
    def manifest(self) -> dict[str, Any]:
        """What was asked for and by what it was made: configuration, build, command line, time."""
        return self._manifest

    def to_dict(self) -> dict[str, Any]:
        """The content of result.json."""
        if self._content is None:
            raise UsageError(f"{self.folder}: this run has not come to its end; the same call goes on with it")
        copy: dict[str, Any] = json.loads(json.dumps(self._content))
        return copy


def load_run(folder: Union[str, Path]) -> Run:
    """Reads a run's folder, made here or by the program, finished or not."""
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


def _own_command() -> list[str]:
    """What to run again, where no command of the program's could."""
    main = sys.modules.get("__main__")
    script = getattr(main, "__file__", None)
    return [sys.executable, os.path.abspath(script)] if script else ["#", "the same call in Python, or in the notebook"]


def _make_command(problem: Problem, optimizer: AnyOptimizer, settings: dict[str, Optional[str]], options: list[str]) -> list[str]:
    """What goes on with the run: the program can do it, if the optimizer is one of its own."""
    if not isinstance(optimizer, str):
        return _own_command()
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
    problem: Union[Problem, str, Path],
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
    """Lets an optimizer loose on a problem, as `armwright optimize` does: the same folder, journal, judging and result, bit for bit.

    Interrupted by Ctrl-C, a time limit or a crash, the same call goes on where it was. A run that is complete is read and not made again.

    Parameters
    ----------
    problem : Problem, str or path
        Or its name; then `set` may change its settings.
    optimizer : str, Optimizer, or class derived from it, optional
        Default: the problem's own.
    seed : int
        Feeds the optimizer's random choices and nothing else.
    budget : int, optional
        Training cases to simulate. Default: the problem's.
    options : mapping, optional
        Of the optimizer: {"population": 50}.
    schedule : str, optional
        Which training cases: "fixed:K", "fresh:K" or "coevolution:K".
    racing : str, optional
        "none", "halving:FIRST_CASES:ETA" or "abandonment:MARGIN:CHUNK_CASES".
    out : str or path, optional
        The run's folder. Default: results/PROBLEM-OPTIMIZER-seedN in the current folder, as of the program.
    new : bool
        Another run beside one that is there: FOLDER-002, FOLDER-003, ...
    jobs : int, optional
        Threads; the result does not depend on it. Default: $ARMWRIGHT_JOBS or all cores.
    time_limit_s : float, optional
        Stop, resumably, after so many seconds; the Run that is returned is then not `finished`.
    progress : optional
        None or True: shown in a notebook and on a terminal, not elsewhere. False: not at all. A callable is called with a Progress every
        now and then, on the thread that called; what it raises stops the run, resumably.

    Raises
    ------
    KeyboardInterrupt
        With how to go on.
    UsageError, BadDataError, BusyError, IoError
        With the program's messages.
    """
    if not isinstance(problem, Problem):
        problem = load_problem(problem, set=set)
    elif set is not None:
        raise UsageError("set is for a problem that is given by its name; load_problem(..., set=...) takes it for this one")
    chosen: AnyOptimizer = problem.optimizer if optimizer is None else optimizer
    row = to_row(chosen)
    texts = to_options(options)
    seed = to_whole("seed", seed, _LARGEST_SEED)
    command = _make_command(problem, chosen, {"--seed": str(seed), "--budget": None if budget is None else str(budget),
                                              "--schedule": schedule, "--racing": racing}, texts)
    with Listener(progress) as listener:
        for note in problem._inner.check_paths():
            listener("warning: " + note, None)
        try:
            folder, _ = _armwright.optimize(problem._inner, row, texts, seed, budget, schedule, racing, None if out is None else str(out), new,
                                            to_jobs(jobs), time_limit_s, command, listener)
        except KeyboardInterrupt:
            raise KeyboardInterrupt("interrupted; what was evaluated is recorded, and the same call of armwright.optimize() goes on "
                                    "from there" + (" (without new=True, and out= its folder)" if new else "")) from None
    return load_run(folder)
