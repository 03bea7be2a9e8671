"""The examples run, quickly, and come to what they say; one has its fifteen lines."""
import pathlib
import re
import subprocess
import sys
import unittest

from support import FolderTest, ROOT

EXAMPLES = ROOT / "python/examples"


class ExamplesTest(FolderTest):
    def run_example(self, name, *words):
        done = subprocess.run([sys.executable, str(EXAMPLES / name), *words], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_all_are_tried(self):
        self.assertEqual({path.name for path in EXAMPLES.glob("*.py")}, {"scipy_optimize.py", "plot_study.py", "own_optimizer.py", "own_problem.py"})

    def test_scipy(self):
        told = self.run_example("scipy_optimize.py", "4")
        start, end = map(float, re.search(r"training: ([\d.]+) mm at the start, ([\d.]+) mm after", told).groups())
        self.assertLess(end, start)
        self.assertIn("failures of 100", told)

    def test_plot(self):
        self.run_example("plot_study.py")
        self.assertEqual(pathlib.Path("study.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertIn("other.png shows results/plot_study", self.run_example("plot_study.py", "results/plot_study", "other.png"))

    def test_own_problem(self):
        told = self.run_example("own_problem.py", "600")
        self.assertRegex(told, r"cmaes: 0\.\d+ kg with")
        self.assertIn("report results/springs makes", told)

    def test_own_optimizer_and_its_fifteen_lines(self):
        told = self.run_example("own_optimizer.py", "2", "60")
        self.assertIn("python:Hillclimber", told)
        lines = (EXAMPLES / "own_optimizer.py").read_text().split("\n")
        begin = next(i for i, line in enumerate(lines) if line.startswith("class Hillclimber"))
        end = next(i for i, line in enumerate(lines) if line.startswith("if __name__"))
        self.assertLessEqual(len("\n".join(lines[begin:end]).rstrip().split("\n")), 15)


if __name__ == "__main__":
    unittest.main()
