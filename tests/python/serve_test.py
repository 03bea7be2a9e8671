"""A class served as a program does what it does within Python.

(That `armwright check-plugin` finds nothing takes 200 starts of Python with numpy, most of a minute, and is left to whoever changes
server.py: armwright check-plugin 'exec:/usr/bin/python3 SCRIPT'. The class itself is checked in run_test.)
"""
import json
import pathlib
import sys
import unittest

from support import FAST, FolderTest, Steps

import armwright

SCRIPT = """import sys
sys.path.insert(0, {tests!r})
import armwright
from support import Steps

class Loud(Steps):
    def minimize(self, evaluator, seed):
        print("hello from the optimizer")
        super().minimize(evaluator, seed)

armwright.serve(Loud)
"""

OTHER = """import numpy as np
import armwright

class Other(armwright.Optimizer):
    capabilities = ("generations", "residuals", "bounds")

    def minimize(self, evaluator, seed):
        for generation in range(2):
            evaluator.begin_generation()
            start, before = evaluator.problem.start, evaluator.remaining
            scores = evaluator.evaluate([start, start + 0.01 * generation])
            if evaluator.stopped:
                return
            assert np.allclose((scores.residuals**2).sum(axis=1), scores.values) and scores.ok.all() and not scores.clipped.any()
            assert len(scores) == 2 and evaluator.remaining == before - 2 and scores.constraints.shape == (2, 0)
            evaluator.recommend(start)
        raise AssertionError("enough")

armwright.serve(Other)
"""


class ServeTest(FolderTest):
    def setUp(self):
        super().setUp()
        pathlib.Path("mine.py").write_text(SCRIPT.format(tests=str(pathlib.Path(__file__).resolve().parent)))
        self.plugin = f"exec:{sys.executable} mine.py"

    def test_asks_for_the_same_points(self):
        self.run_program("optimize", "q1-complex", "--optimizer", self.plugin,
                         *"--engine articulated --budget 60 --opt batch=7 --seed 4 --out its --quiet".split(), expect=3)
        its = armwright.load_run("its").history
        mine = armwright.optimize("q1-complex", Steps, set=FAST, budget=60, options={"batch": 7}, seed=4, out="mine").history
        self.assertEqual(its.x.tobytes(), mine.x.tobytes())
        self.assertIn("hello from the optimizer", pathlib.Path("its/optimizer.log").read_text())

    def test_generations_residuals_failures_and_recommendations(self):
        pathlib.Path("mine.py").write_text(OTHER)
        told = self.run_program("optimize", "sphere", "--optimizer", self.plugin, "--budget", "21", "--out", "its", "--json", "--quiet", expect=3)
        its = armwright.load_run("its")
        self.assertIn("it ended with exit code 1", its.failure)
        self.assertIn("AssertionError: enough", pathlib.Path("its/optimizer.log").read_text())
        self.assertEqual(json.loads(told), its.to_dict())
        self.assertEqual(its.history.generation.tolist(), [1, 1, 2, 2])
        self.assertTrue(any(one.get("recommended") for one in its.candidates))
        # Without faults it sees the end of the budget, and ends.
        self.run_program("optimize", "sphere", "--optimizer", self.plugin, "--budget", "3", "--out", "short", "--quiet", expect=3)
        self.assertEqual(armwright.load_run("short").end_reason, "budget")


if __name__ == "__main__":
    unittest.main()
