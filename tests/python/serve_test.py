"""A class served as a program: it keeps every promise of a plugin, and does what it does within Python."""
import pathlib
import sys
import unittest

from support import FolderTest, Steps

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


class ServeTest(FolderTest):
    def setUp(self):
        super().setUp()
        pathlib.Path("mine.py").write_text(SCRIPT.format(tests=str(pathlib.Path(__file__).resolve().parent)))
        self.plugin = f"exec:{sys.executable} mine.py"

    def test_keeps_every_promise(self):
        self.assertIn("It keeps every promise.", self.run_program("check-plugin", self.plugin))

    def test_asks_for_the_same_points(self):
        self.run_program("optimize", "q1-complex", "--engine", "articulated", "--optimizer", self.plugin, "--budget", "60", "--opt", "batch=7", "--seed", "4", "--out", "its", "--quiet")
        its = armwright.load_run("its").history
        mine = armwright.optimize("q1-complex", Steps, set={"physics.engine": "articulated"}, budget=60, options={"batch": 7}, seed=4, out="mine").history
        self.assertEqual(its.x.tobytes(), mine.x.tobytes())
        self.assertIn("hello from the optimizer", pathlib.Path("its/optimizer.log").read_text())


if __name__ == "__main__":
    unittest.main()
