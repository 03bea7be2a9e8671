"""Runs a class as a program that exchanges lines of JSON over standard input and output.

Optimizers follow docs/plugin-protocol.md, problems docs/problem-protocol.md.
"""

from __future__ import annotations

import json
import os
import sys
from typing import Any, TextIO, Union, cast

import numpy as np

from ._values import FloatArray
from .errors import UsageError
from .optimizer import Optimizer, read_optimizer
from .problem import STATUSES
from .user_problem import AnyUserProblem, PythonProblem, is_user_problem


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


def serve(plugin: Union[Optimizer, type[Optimizer], AnyUserProblem]) -> None:
    """Makes a script an optimizer or a problem for the command line.

    The program runs it as `armwright optimize q1-complex --optimizer 'exec:python3 SCRIPT'`, or for a problem as
    `armwright optimize 'exec:python3 SCRIPT'`. Text that the class prints goes to standard error. For an optimizer the program writes it into
    optimizer.log of the run. Standard output is only for the protocol.

    Examples
    --------
    >>> if __name__ == "__main__":
    ...     armwright.serve(MyOptimizer)
    """
    lines, answers = sys.stdin, sys.stdout
    sys.stdout = sys.stderr
    if is_user_problem(plugin):
        _serve_problem(PythonProblem(cast(AnyUserProblem, plugin)), lines, answers)
        return
    mine = read_optimizer(cast(Union[Optimizer, type[Optimizer]], plugin))
    host = _Host(lines, answers)
    host.receive()  # hello
    host.send(mine.description)
    task = host.receive()
    if task["type"] == "minimize":
        host.begin(task)
        mine.run(host, task["options"], task["seed"])
        host.send({"type": "done", "reason": host.reason} if host.reason else {"type": "done"})


def _serve_problem(problem: PythonProblem, lines: TextIO, answers: TextIO) -> None:
    def send(message: str) -> None:
        answers.write(message + "\n")
        answers.flush()

    try:
        for line in iter(lines.readline, ""):
            message = json.loads(line)
            if message["type"] == "hello":
                send(problem.text)
            elif message["type"] == "quit":
                return
            else:
                problem.answer_message(message, send)
    except BrokenPipeError:
        os._exit(0)  # the host has ended
