"""Identification: a robot's plant from logs of its motion."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Mapping, Optional, Sequence, Union

from . import _armwright
from ._values import Settings, to_settings
from .optimizer import AnyOptimizer
from .problem import load_problem
from .progress import Show
from .run import Run, optimize

Files = Union[str, Path, Sequence[Union[str, Path]]]

# As `armwright identify` has them.
_OPTIMIZER = "ceres:lm"
_OPTIONS = {"derivatives": "exact", "transform": "none"}


def _list_files(files: Files) -> list[str]:
    names = [files] if isinstance(files, (str, Path)) else files
    return [str(Path(name).absolute()) for name in names]


def _list_pairs(pairs: Optional[Mapping[Any, Any]]) -> Optional[list[str]]:
    return None if pairs is None else [f"{key}={value}" for key, value in pairs.items()]


def identify(
    logs: Files,
    robot: Union[str, Path],
    *,
    validate: Files = (),
    fit: Optional[Sequence[str]] = None,
    payload_kg: Optional[float] = None,
    payload_com_m: Optional[Sequence[float]] = None,
    base: Optional[str] = None,
    tip: Optional[str] = None,
    plant: Union[None, str, Path] = None,
    columns: Optional[Mapping[str, str]] = None,
    units: Optional[Mapping[str, str]] = None,
    gear_ratios: Optional[Mapping[Union[int, str], Union[float, str]]] = None,
    signs: Optional[Mapping[Union[int, str], int]] = None,
    joints: Optional[Sequence[str]] = None,
    topic: Optional[str] = None,
    cutoff_hz: Optional[float] = None,
    optimizer: Optional[AnyOptimizer] = None,
    options: Optional[Mapping[str, Any]] = None,
    seed: int = 1,
    budget: Optional[int] = None,
    set: Optional[Settings] = None,
    out: Union[None, str, Path] = None,
    new: bool = False,
    jobs: Optional[int] = None,
    time_limit_s: Optional[float] = None,
    progress: Show = None,
) -> Run:
    """Finds a robot's plant in logs of its motion, as `armwright identify` does, bit for bit.

    The attribute `identification` of the returned Run has the parameters with their intervals, the errors and the doubts. The folder of the
    run has plant.toml, for load_problem(robot=..., plant=...).

    Parameters
    ----------
    logs : str, path, or sequence of these
        CSV files or bags of ROS 2. Several logs are fitted together.
    robot : str or path
        The robot's URDF or MJCF file, or the name of a shipped robot.
    validate : str, path, or sequence of these
        Logs that are held back. They only judge the fit.
    fit : sequence of str, optional
        What is fitted: "friction", "stribeck", "armature", "payload", "counterbalance", "counterbalance_slope", "stiffness", "delay",
        "inertial". Default: friction and armature.
    payload_kg, payload_com_m : float and 3 floats, optional
        The payload that the robot carried, as far as it is known, and its centre of mass in the tip's frame.
    base, tip, plant : optional
        As in load_problem().
    columns, units, gear_ratios, signs : mapping, optional
        What the names in the log do not say: {"position_1": "q1"}, {"position": "deg"}, {"joint_1": "1798/7"}, {"joint_3": -1}.
    joints : sequence of str, optional
        The log's names of the robot's joints, in the robot's order.
    topic : str, optional
        The topic of a bag. Default: the only one that fits.
    cutoff_hz : float, optional
        The cutoff of the filter. Default: 8 Hz.
    optimizer, options : optional
        As in optimize(). Default: "ceres:lm" with exact derivatives.
    seed, budget, out, new, jobs, time_limit_s, progress : optional
        As in optimize(). The default folder is results/ROBOT-plant-OPTIMIZER-seedN and what was set.
    set : mapping or list of str, optional
        Further settings, such as {"identification.prior_scale": 0}.

    Raises
    ------
    BadDataError
        If a log cannot be fitted. The message names the file, the column, the line and what to do.
    """
    given = {
        "logs": _list_files(logs), "validate": _list_files(validate) or None, "fit": fit, "payload_kg": payload_kg,
        "payload_com_m": payload_com_m, "columns": _list_pairs(columns), "units": _list_pairs(units),
        "gear_ratios": _list_pairs(gear_ratios), "signs": _list_pairs(signs), "joints": joints, "topic": topic, "cutoff_hz": cutoff_hz,
    }
    settings = to_settings({f"identification.{key}": value for key, value in given.items() if value is not None}) + to_settings(set)
    if optimizer is None and options is None:
        optimizer, options = _OPTIMIZER, _OPTIONS
    problem = load_problem(Path(_armwright.config_folder()) / "problems" / "_identify.toml", set=settings, robot=robot, base=base, tip=tip,
                           plant=plant)
    return optimize(problem, optimizer, seed=seed, budget=budget, options=options, out=out, new=new, jobs=jobs, time_limit_s=time_limit_s,
                    progress=progress)
