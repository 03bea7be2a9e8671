"""Runs an optimizer class as a plugin program, by the protocol of docs/plugin-protocol.md over standard input and output."""

from __future__ import annotations

import json
import os
import sys
from typing import Any, TextIO, Union

import numpy as np

from ._values import FloatArray
from .errors import UsageError
from .optimizer import Optimizer, read_optimizer
from .problem import STATUSES


class _Host:
    """The connection to the program at the other end of the pipe, with the interface that an Evaluator uses."""

    def __init__(self, lines: TextIO, answers: TextIO) -> None:
        self._lines = lines
        self._answers = answers
        self._begins_generation = False
        self._problem: dict[str, Any] = {}
        self.stopped = False
        self.remaining = 0
        self.reason = ""

    def receive(self) -> dict[str, Any]:
        line = self._lines.readline()
        if not line:
            os._exit(0)  # the host has ended
        message: dict[str, Any] = json.loads(line)
        return message

    def send(self, message: dict[str, Any]) -> None:
        try:
            self._answers.write(json.dumps(message, allow_nan=False) + "\n")
            self._answers.flush()
        except BrokenPipeError:
            os._exit(0)  # the host has ended

    def begin(self, task: dict[str, Any]) -> None:
        self._problem = task["problem"]
        self.remaining = task["remaining"]
        self.stopped = self.remaining <= 0

    def describe_problem(self) -> str:
        return json.dumps(self._problem)

    def evaluate(self, points: FloatArray, with_jacobian: bool, /) -> tuple[Any, ...]:
        if with_jacobian:
            raise UsageError("the plugin protocol has no exact derivatives; run the class within Python: armwright.optimize()")
        variables = len(self._problem["variables"])
        if points.shape[1] != variables or not np.isfinite(points).all():
            raise UsageError(f"X has the shape {points.shape}; it must be (n, {variables}), of finite numbers")
        scores: list[dict[str, Any]] = []
        if not self.stopped and len(points) > 0:
            self.send({"type": "ask", "points": points.tolist(), "generation": self._begins_generation})
            self._begins_generation = False
            answer = self.receive()
            scores, self.stopped, self.remaining = answer["scores"], answer["stopped"], answer["remaining"]
        count, constraints = len(self._problem["objectives"]), len(self._problem["constraints"])
        residuals = [score["residuals"] for score in scores if score.get("residuals")]
        rest = None
        if residuals:
            values = np.full((len(scores), len(residuals[0])), np.inf)
            for row, score in enumerate(scores):
                if score.get("residuals"):
                    values[row] = score["residuals"]
            rest = (values, np.isinf(values))
        return (
            np.array([score["objectives"] for score in scores], dtype=np.float64).reshape(len(scores), count),
            np.array([score["constraints"] or [np.inf] * constraints for score in scores], dtype=np.float64).reshape(len(scores), constraints),
            np.array([STATUSES.index(score["status"]) for score in scores], dtype=np.uint8),
            np.array([score["clipped"] for score in scores], dtype=bool),
            rest,
            None,
        )

    def begin_generation(self) -> None:
        self._begins_generation = True

    def recommend(self, point: FloatArray, /) -> None:
        self.send({"type": "recommend", "x": point[0].tolist()})

    def explain_end(self, reason: str, /) -> None:
        self.reason = reason


def serve(optimizer: Union[Optimizer, type[Optimizer]]) -> None:
    """Makes a script an optimizer for the command line: `armwright optimize q1-complex --optimizer 'exec:python3 SCRIPT'`.

    Text that the optimizer prints goes to standard error, and so into optimizer.log of the run. Standard output is only for the protocol.

    Examples
    --------
    >>> if __name__ == "__main__":
    ...     armwright.serve(MyOptimizer)
    """
    mine = read_optimizer(optimizer)
    host = _Host(sys.stdin, sys.stdout)
    sys.stdout = sys.stderr
    host.receive()  # hello
    host.send(mine.description)
    task = host.receive()
    if task["type"] == "minimize":
        host.begin(task)
        mine.run(host, task["options"], task["seed"])
        host.send({"type": "done", "reason": host.reason} if host.reason else {"type": "done"})
