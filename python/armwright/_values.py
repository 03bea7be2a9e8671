"""Converts Python values to the form that the library reads: settings and options to KEY=VALUE texts, points to arrays."""

from __future__ import annotations

import json
import math
import os
import re
from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from .errors import UsageError

FloatArray = npt.NDArray[np.float64]
MaskedFloats = np.ma.MaskedArray[Any, np.dtype[np.float64]]
Settings = Union[Mapping[str, Any], Sequence[str]]
MOST_JOBS = 1024


def to_toml(value: Any) -> str:
    """Returns a value in TOML. A plain word stays without quotes, as on the command line. UsageError if TOML cannot hold the value."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        if not math.isfinite(value):
            raise UsageError(f"a setting is {value}; it must be a finite number")
        return repr(float(value))
    if isinstance(value, (str, os.PathLike)):
        text = os.fspath(value)
        is_word = re.fullmatch(r"[A-Za-z_][A-Za-z0-9_-]*", text) and text not in ("true", "false", "inf", "nan")
        return text if is_word else json.dumps(text, ensure_ascii=False)
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(quote_words(one) for one in value) + "]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{json.dumps(str(key))} = {quote_words(one)}" for key, one in value.items()) + "}"
    raise UsageError(f"a setting is a {type(value).__name__}; it must be a number, a truth value, a text, or a list or table of these")


def quote_words(value: Any) -> str:
    """Returns the value in TOML for use within a list or table, where a word needs quotes."""
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else to_toml(value)


def to_settings(settings: Optional[Settings]) -> list[str]:
    """Returns the settings as KEY=VALUE texts. They may be a mapping or a sequence of such texts."""
    if settings is None:
        return []
    if isinstance(settings, Mapping):
        return [f"{key}={to_toml(value)}" for key, value in settings.items()]
    if isinstance(settings, str):
        raise UsageError(f"set is the text {settings!r}; it must be a mapping such as {{'physics.engine': 'articulated'}}, or a list of "
                         "KEY=VALUE texts")
    return [str(one) for one in settings]


def to_options(options: Optional[Mapping[str, Any]]) -> list[str]:
    """Returns the options of an optimizer as KEY=VALUE texts."""
    texts = []
    for name, value in (options or {}).items():
        if isinstance(value, (bool, np.bool_)):
            value = "true" if value else "false"
        elif isinstance(value, (float, np.floating)):
            value = repr(float(value))
        texts.append(f"{name}={value}")
    return texts


def to_jobs(jobs: Optional[int]) -> int:
    """Returns the number of threads: `jobs`, else $ARMWRIGHT_JOBS, else the number of cores. UsageError if it is not from 1 to MOST_JOBS."""
    name = "jobs"
    if jobs is None:
        text = os.environ.get("ARMWRIGHT_JOBS", "")
        if not text:
            return max(1, os.cpu_count() or 1)
        name = "ARMWRIGHT_JOBS"
        jobs = int(text) if text.isdecimal() else -1
    if isinstance(jobs, bool) or not isinstance(jobs, (int, np.integer)) or not 1 <= jobs <= MOST_JOBS:
        raise UsageError(f"{name} is {jobs!r}; it must be an integer from 1 to {MOST_JOBS}")
    return int(jobs)


def to_whole(name: str, value: Any, most: int) -> int:
    """Returns the value as an int. UsageError if it is not an integer from 0 to `most`."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)) or not 0 <= value <= most:
        raise UsageError(f"{name} is {value!r}; it must be an integer from 0 to {most}")
    return int(value)


def to_points(points: npt.ArrayLike, name: str = "X") -> FloatArray:
    """Returns points as a matrix of doubles in C order, one row per point. An array that already has this form is not copied."""
    array = np.asarray(points)
    if array.dtype.kind not in "fiu":
        raise UsageError(f"{name} holds {array.dtype}; it must hold real numbers")
    if array.ndim == 1:
        array = array[np.newaxis, :]
    return np.ascontiguousarray(array, dtype=np.float64)


def to_masked(pair: tuple[FloatArray, npt.NDArray[np.bool_]]) -> MaskedFloats:
    """Returns a masked array of (values, mask). Below the mask the values are infinite, never NaN."""
    values, mask = pair
    masked: MaskedFloats = np.ma.MaskedArray(values, mask=mask)  # type: ignore[no-untyped-call]
    return masked


def to_masked_matrices(pair: tuple[FloatArray, npt.NDArray[np.bool_]], columns: int) -> MaskedFloats:
    """Returns a masked array (n, rows, columns). Each row of the input holds one matrix, row after row."""
    values, mask = pair
    shape = (len(values), values.shape[1] // columns, columns)
    return to_masked((values.reshape(shape), mask.reshape(shape)))


def to_list(masked: MaskedFloats) -> list[Any]:
    """Returns plain lists, with None for masked values."""
    plain: list[Any] = masked.tolist()  # type: ignore[no-untyped-call]
    return plain
