"""What the tests of the Python package share. Each file is a program: ctest runs it with Debian's Python and the build tree's package."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

import armwright

PROGRAM = os.environ["ARMWRIGHT_BINARY"]
ROOT = pathlib.Path(os.environ["ARMWRIGHT_SOURCE"])
FAST = {"physics.engine": "articulated"}


def run_program(*words, cwd, expect=0):
    """The program `armwright`; its standard output. `expect`: its exit code."""
    done = subprocess.run([PROGRAM, *map(str, words)], cwd=cwd, capture_output=True, text=True)
    if done.returncode != expect:
        raise AssertionError(f"{words} ended with {done.returncode}, not {expect}:\n{done.stdout}\n{done.stderr}")
    return done.stdout


class FolderTest(unittest.TestCase):
    """In a folder of its own, which is the current one."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(self.folder)

    def run_program(self, *words, expect=0):
        return run_program(*words, cwd=self.folder, expect=expect)

    def expect_error(self, kind, *pieces):
        """A context that expects this error, and these pieces in its message."""
        return _ErrorContext(self, kind, pieces)


class _ErrorContext:
    def __init__(self, test, kind, pieces):
        self._context = test.assertRaises(kind)
        self._test = test
        self._pieces = pieces

    def __enter__(self):
        self._context.__enter__()
        return self._context

    def __exit__(self, *what):
        is_expected = self._context.__exit__(*what)
        for piece in self._pieces if is_expected else ():
            self._test.assertIn(piece, str(self._context.exception))
        return is_expected


def read_bytes(*parts):
    return pathlib.Path(*parts).read_bytes()


class Steps(armwright.Optimizer):
    """Random points about the best so far: what an optimizer in Python may look like."""

    name = "steps"
    capabilities = ("bounds", "batch", "stochastic")
    options = (armwright.Option("batch", 4, "points at a time", 1, 100), armwright.Option("spread", 0.2, "share of the box", 0.0, 1.0))

    def minimize(self, evaluator, seed):
        random = np.random.default_rng(seed)
        problem = evaluator.problem
        best = problem.to_unit(problem.start)
        least = np.inf
        while not evaluator.stopped:
            shares = best + self.settings["spread"] * random.standard_normal((self.settings["batch"], len(problem)))
            shares[0] = best if np.isinf(least) else shares[0]
            scores = evaluator.evaluate(problem.from_unit(np.clip(shares, 0, 1)))
            if len(scores) > 0 and scores.values.min() < least:
                least = scores.values.min()
                best = np.clip(shares, 0, 1)[scores.values.argmin()]
