"""Comparisons of optimizers under equal conditions, with statistics and a verdict. The program can read their folders too."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Optional, Sequence, Union, cast

import numpy as np
import numpy.typing as npt

from . import _armwright
from ._values import FloatArray, Settings, to_jobs, to_settings, to_whole
from .errors import UsageError
from .optimizer import AnyOptimizer, to_row
from .problem import load_problem
from .progress import Listener, Show
from .run import Run, load_run
from .user_problem import AnyUserProblem, is_user_problem


class Study:
    """The results of a comparison. Smaller values are better. An infinite value belongs to a run without a working winner.

    Attributes
    ----------
    folder : Path
        The folder of the comparison, for `armwright show`, `report` and `export`.
    finished : bool
        False if some cells are not finished (`missing` names them). The same call continues them.
    name, title : str
    problems, optimizers : tuple of str
        Labels, in the order of all arrays below.
    baselines : frozenset of str
        Optimizers that take part without being named.
    replicates, budget : int
    values : array (optimizers, problems, replicates)
        The value of every run: that of its winner on the test set.
    start_values : array (optimizers, problems, replicates)
        The value of the design from which the run started.
    verdict : list of str
        Sentences that follow only from the statistics.
    """

    def __init__(self, folder: Path, content: dict[str, Any]) -> None:
        self.folder = folder
        self._content = content
        self._result: dict[str, Any] = content["result"]
        plan = content["plan"]
        self.name: str = plan["name"]
        self.title: str = plan["title"]
        self.seed: int = plan["seed"]
        self.replicates: int = plan["replicates"]
        self.budget: int = plan["budget"]
        self.missing: list[str] = content["missing"]
        self.finished = not self.missing
        self.problems: tuple[str, ...] = tuple(one["label"] for one in plan["problems"])
        self.optimizers: tuple[str, ...] = tuple(one["label"] for one in plan["optimizers"])
        self.baselines = frozenset(one["label"] for one in plan["optimizers"] if one["baseline"])
        self.verdict: list[str] = self._result["verdict"]
        self._checkpoints = {one["label"]: np.array(one["checkpoints"], dtype=np.int64) for one in plan["problems"]}
        shape = (len(self.optimizers), len(self.problems), self.replicates)
        self.values: FloatArray = np.full(shape, np.inf)
        self.start_values: FloatArray = np.full(shape, np.inf)
        self._cells = {(cell["label"], cell["problem"], cell["replicate"]): cell for cell in content["cells"]}
        for (optimizer, problem, replicate), cell in self._cells.items():
            place = (self.optimizers.index(optimizer), self.problems.index(problem), replicate - 1)
            self.values[place] = _to_value(cell["value"])
            self.start_values[place] = _to_value(cell["start_value"])

    def __repr__(self) -> str:
        state = "" if self.finished else f", {len(self.missing)} cells missing"
        size = f"{len(self.optimizers)} optimizers, {len(self.problems)} problems, {self.replicates} replicates"
        return f"<armwright.Study {self.folder}: {size}{state}>"

    def checkpoints(self, problem: str) -> npt.NDArray[np.int64]:
        """Returns the budgets, in cases, at which incumbents were tested."""
        return self._checkpoints[self._check("problem", problem, self.problems)]

    def curves(self, problem: str, optimizer: str) -> FloatArray:
        """Returns the test values of the incumbents, (replicates, checkpoints). Before the first incumbent they are infinite."""
        budgets = self.checkpoints(problem)
        curves = np.full((self.replicates, len(budgets)), np.inf)
        for replicate in range(1, self.replicates + 1):
            for budget, value, *_ in self.cell(problem, optimizer, replicate)["curve"]:
                curves[replicate - 1, np.searchsorted(budgets, budget)] = _to_value(value)
        return curves

    def cell(self, problem: str, optimizer: str, replicate: int) -> dict[str, Any]:
        """Returns all recorded data of one run: x, value, validation_value, objectives, metrics, test, curve, cases, failure, ..."""
        self._check("problem", problem, self.problems)
        self._check("optimizer", optimizer, self.optimizers)
        if not 1 <= replicate <= self.replicates:
            raise UsageError(f"replicate is {replicate}; it must be an integer from 1 to {self.replicates}")
        found: dict[str, Any] = self._cells[optimizer, problem, replicate]
        return found

    def run(self, problem: str, optimizer: str, replicate: int) -> Run:
        """Returns the cell as a run, with its history."""
        self.cell(problem, optimizer, replicate)
        return load_run(self.folder / "cells" / _escape(problem) / _escape(optimizer) / f"r{replicate:02}")

    def pairs(self, problem: Optional[str] = None) -> list[dict[str, Any]]:
        """Returns the comparison of every two optimizers: a, b, p, p_holm, a12, wins (of a, ties, of b), significant.

        a12 is the probability that a run of a is better. The comparison is on one problem, or over all problems if `problem` is None.
        """
        found: list[dict[str, Any]] = self._find(problem)["pairs"] if problem is not None else self._result["over_problems"]["pairs"]
        return found

    def table(self, problem: str) -> dict[str, dict[str, Any]]:
        """Returns the statistics by optimizer, best first: values, quartiles, median_interval, mean_rank, failed, running_times, ..."""
        found = self._find(problem)
        return {label: found["optimizers"][label] for label in found["order"]}

    @property
    def mean_ranks(self) -> dict[str, float]:
        """The mean rank of each optimizer over the problems; 1 is best."""
        found: dict[str, float] = self._result["over_problems"]["mean_ranks"]
        return found

    def to_dict(self) -> dict[str, Any]:
        """Returns the content of result.json."""
        copy: dict[str, Any] = json.loads(json.dumps(self._result))
        return copy

    def _find(self, problem: str) -> dict[str, Any]:
        self._check("problem", problem, self.problems)
        found: dict[str, Any] = next(one for one in self._result["problems"] if one["problem"] == problem)
        return found

    @staticmethod
    def _check(what: str, name: str, valid: Sequence[str]) -> str:
        if name not in valid:
            raise UsageError(f"unknown {what} of the study {name!r}; valid: {', '.join(valid)}")
        return name


def _to_value(value: Optional[float]) -> float:
    return np.inf if value is None else value


def _escape(label: str) -> str:
    return _armwright.escape_name(label)


def load_study(folder: Union[str, Path]) -> Study:
    """Reads the folder of a comparison that this package or the program made, finished or not. Missing cells have infinite values."""
    return Study(Path(folder), json.loads(_armwright.load_study(str(folder))))


def compare(
    problems: Optional[Sequence[Union[str, Path, AnyUserProblem]]] = None,
    optimizers: Optional[Sequence[AnyOptimizer]] = None,
    *,
    study: Union[None, str, Path] = None,
    replicates: Optional[int] = None,
    budget: Optional[int] = None,
    set: Optional[Settings] = None,
    schedule: Optional[str] = None,
    seed: Optional[int] = None,
    baselines: bool = True,
    trust: bool = False,
    out: Union[None, str, Path] = None,
    new: bool = False,
    jobs: Optional[int] = None,
    time_limit_s: Optional[float] = None,
    progress: Show = None,
) -> Study:
    """Compares optimizers under equal conditions, as `armwright compare` does: the same folder, cells, statistics and verdict.

    The results are the same bit for bit. Every optimizer gets the same budget. In one replicate all optimizers get the same training
    cases and the same start. Random search and a local search take part as baselines. If the comparison is interrupted, the same call
    continues it. A call with more replicates, problems or optimizers runs only the new cells.

    The runs of optimizers or problems that are classes come first, one after the other in this process on `jobs` threads. All other runs have processes of their own, and
    `jobs` of them run at a time.

    Parameters
    ----------
    problems : sequence of str, path, UserProblem, or classes derived from it
        Names, files, or problems of your own.
    optimizers : sequence of str, Optimizer, or classes derived from it
        They use their default options. To give them other options, or schedules of their own, use a study file.
    study : str or path, optional
        A study file, or the name of a shipped one. Other arguments replace what the file says.
    replicates : int, optional
        The number of runs of every optimizer on every problem (default: 15).
    budget : int
        The number of training cases per run.
    set : mapping or list of str, optional
        Settings of every problem.
    schedule : str, optional
        The schedule of training cases: "fixed:K"; or "fresh:K" or "coevolution:K" if all optimizers have generations; or "own": "fresh:1" for
        optimizers with generations, "fixed:5" for the others.
    seed : int, optional
        The seed of the study. It draws starts, training cases and the seeds of the optimizers (default: 1).
    baselines : bool
        Whether the baselines take part. If they do not, the verdict says so.
    trust : bool
        Whether to run the plugins that a recorded study names, although you did not start it on this machine. A plugin has all rights that
        you have. Plugins that `optimizers` names run without it.
    out, new, jobs, time_limit_s, progress : optional
        As in optimize(). The default folder is results/NAME.
    """
    if problems is None and study is None:
        raise UsageError("nothing to compare; give problems and optimizers, or study=FILE")
    for name, names in (("problems", problems), ("optimizers", optimizers)):
        if isinstance(names, str):
            raise UsageError(f"{name} is the text {names!r}; it must be a list, such as [{names!r}]")
    labels: list[str] = []
    own = []
    for problem in problems or []:
        if is_user_problem(problem):
            own.append(load_problem(cast(AnyUserProblem, problem))._inner)
            labels.append(own[-1].asked_name)
        elif isinstance(problem, (str, Path)):
            labels.append(str(problem))
        else:
            raise UsageError(f"problems holds {problem!r}; it must hold names, files or problems of your own, whose settings `set` changes "
                             "for all")
    rows = [to_row(optimizer) for optimizer in optimizers or []]
    with Listener(progress) as listener:
        try:
            folder, text = _armwright.compare(
                "" if study is None else str(study), labels, rows, own, to_settings(set), replicates, budget,
                schedule, None if seed is None else to_whole("seed", seed, 2**63 - 1), baselines, trust, None if out is None else str(out), new,
                to_jobs(jobs), time_limit_s, listener)
        except KeyboardInterrupt:
            raise KeyboardInterrupt("interrupted; all evaluations so far are recorded, and the same call of armwright.compare() goes on from "
                                    "there" + (" (without new=True, and out= its folder)" if new else "")) from None
    return Study(Path(folder), json.loads(text)) if text is not None else load_study(folder)
