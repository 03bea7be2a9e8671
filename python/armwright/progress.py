"""The progress display of a long call: in place in a notebook, as one line on a terminal, and nowhere else."""

from __future__ import annotations

import importlib
import math
import sys
import time
import warnings
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Callable, Optional, Protocol, Type, Union

from .errors import ArmwrightWarning, UsageError


@dataclass(frozen=True)
class Progress:
    """The progress of a call: the simulated cases and the total number of cases.

    Attributes
    ----------
    phase : str
        "training", "validation" or "test".
    done, total, replayed : int
        Numbers of cases: finished, in total, and taken from the journal (a part of the finished ones).
    generation : int
        0 for optimizers without generations.
    best : float or None
        The best objective so far. If every generation has new cases, it is the best of the last generation.
    """

    phase: str
    done: int
    total: int
    replayed: int
    generation: int
    best: Optional[float]


Show = Union[None, bool, Callable[[Progress], Any]]
_DELAY_S = 0.5  # until the display begins; most calls are quicker
_WIDTH = 30  # of the bar, in characters


class _Screen(Protocol):
    def show(self, text: str) -> None: ...

    def close(self) -> None: ...


class _Terminal:
    def __init__(self) -> None:
        self._is_drawn = False

    def show(self, text: str) -> None:
        sys.stderr.write(f"\r{text[:100]}\x1b[K")
        sys.stderr.flush()
        self._is_drawn = True

    def close(self) -> None:
        if self._is_drawn:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()


class _Notebook:
    def __init__(self, display: Callable[..., Any]) -> None:
        self._display = display
        self._handle: Any = None

    def show(self, text: str) -> None:
        data = {"text/plain": text}
        if self._handle is None:
            self._handle = self._display(data, raw=True, display_id=True)
        else:
            self._handle.update(data, raw=True)

    def close(self) -> None:
        if self._handle is not None:
            self._handle.update({"text/plain": ""}, raw=True)


def _find_screen() -> Optional[_Screen]:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is not None and getattr(shell, "kernel", None) is not None:
        return _Notebook(importlib.import_module("IPython.display").display)
    return _Terminal() if sys.stderr is not None and sys.stderr.isatty() else None


def describe(progress: Progress, elapsed_s: float) -> str:
    """Returns a line with a bar, the finished share, the speed and the best value."""
    share = progress.done / progress.total if progress.total else 1.0
    full = int(_WIDTH * share)
    text = f"{progress.phase} [{'#' * full}{'-' * (_WIDTH - full)}] {math.floor(100 * share)} % {progress.done}/{progress.total}"
    simulated = progress.done - progress.replayed
    if simulated > 0 and elapsed_s > 0:
        text += f"  {simulated / elapsed_s:.3g}/s"
    if progress.best is not None:
        text += f"  best {progress.best:.4g}"
    return text


class Listener:
    """Receives messages from the library. Warnings become Python warnings; progress is shown or passed to a callable of the user."""

    def __init__(self, show: Show) -> None:
        if not (show is None or isinstance(show, bool) or callable(show)):
            raise UsageError(f"progress is {show!r}; it must be True, False, None (where it can be seen) or a callable that takes a Progress")
        self._callable = show if callable(show) else None
        self._screen = _find_screen() if show is None or show is True else None
        self._begin_s = time.monotonic()

    def __call__(self, message: Optional[str], state: Optional[tuple[Any, ...]]) -> None:
        if message is not None:
            for kind in ("warning: ", "error: "):
                if message.startswith(kind):
                    warnings.warn(message[len(kind):], ArmwrightWarning, stacklevel=4)
        if state is not None:
            self._show(Progress(*state))

    def _show(self, progress: Progress) -> None:
        if self._callable is not None:
            self._callable(progress)
        elapsed_s = time.monotonic() - self._begin_s
        if self._screen is not None and elapsed_s > _DELAY_S:
            self._screen.show(describe(progress, elapsed_s))

    def __enter__(self) -> Listener:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], value: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        if self._screen is not None:
            self._screen.close()
