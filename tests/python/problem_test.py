"""Problems from Python: evaluating points and designs gives what the program gives, whatever the threads, and never NaN."""
import json
import os
import pathlib
import pty
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import numpy as np
from support import FAST, FolderTest

import armwright


class ProblemTest(FolderTest):
    @classmethod
    def setUpClass(cls):
        cls.problem = armwright.load_problem("q1-complex", set=FAST)
        random = np.random.default_rng(1)
        cls.points = cls.problem.from_unit(np.clip(cls.problem.to_unit(cls.problem.start) + 0.05 * random.standard_normal((40, 20)), 0, 1))

    def test_says_what_it_is(self):
        problem = self.problem
        self.assertEqual(len(problem), 20)
        self.assertEqual(problem.variables[0].name, "joint_1.p")
        self.assertEqual(problem.lower.shape, (20,))
        self.assertTrue(((problem.lower <= problem.start) & (problem.start <= problem.upper)).all())
        self.assertEqual(problem.objectives, (armwright.Quantity("error", "m"),))
        self.assertEqual(problem.sets["test"], "test/2")
        self.assertEqual(problem.configuration["physics"]["engine"], "articulated")
        self.assertIn("q1-complex", armwright.list_problems())
        self.assertIn("table-a10", armwright.list_designs())

    def test_one_point_stays_a_vector(self):
        problem = self.problem
        for convert in (problem.clip, problem.to_unit, problem.from_unit):
            many = convert(np.vstack([problem.to_unit(problem.start)] * 2))
            one = convert(problem.to_unit(problem.start))
            self.assertEqual((one.shape, many.shape), ((20,), (2, 20)))
            self.assertEqual(convert(problem.to_unit(problem.start).tolist()).shape, (20,))
            self.assertEqual(one.tobytes(), many[1].tobytes())

    def test_discrete_variables_are_rounded(self):
        real = {"name": "gain", "unit": "", "lower": -5, "upper": 5, "start": 1, "scale": "linear"}
        teeth = {"name": "teeth", "unit": "", "lower": 1, "upper": 1000, "start": 3, "scale": "logarithmic", "type": "integer", "choices": []}
        oil = {"name": "oil", "unit": "", "lower": 0, "upper": 2, "start": 0, "scale": "linear", "type": "category", "choices": ["a", "b", "c"]}
        problem = armwright.Description({"name": "mixed", "variables": [real, teeth, oil], "objectives": [{"name": "f", "unit": ""}],
                                         "objective_weights": [], "constraints": [], "has_residuals": False})
        self.assertEqual([v.type for v in problem.variables], ["real", "integer", "category"])
        self.assertEqual(problem.variables[2].choices, ("a", "b", "c"))
        self.assertEqual(problem.is_discrete.tolist(), [False, True, True])
        self.assertEqual(problem.clip([[0.4, 6.5, 1.4], [9, 0.2, 2.6]]).tolist(), [[0.4, 7, 1], [5, 1, 2]])
        self.assertEqual(problem.from_unit([0.5, 1, 0.5]).tolist(), [0, 1000, 1])

    def test_results_print_as_one_line(self):
        done = repr(self.problem.evaluate(self.points, cases=1))
        self.assertRegex(done, r"^<armwright.Evaluations: 40 of 40 ok, smallest value [0-9.e-]+>$")
        problem = armwright.load_problem("q2-e6", set={"physics.judging_engine": "articulated", **FAST})
        judged = repr(problem.evaluate_design("table-a10", cases=12))
        self.assertRegex(judged, r"^<armwright.DesignEvaluation table-a10 on q2-e6, test/2: mean error [0-9.e-]+ mm, 0 of 12 cases failed>$")

    def test_a_package_that_was_not_built_says_how_to_build_it(self):
        package = self.folder / "python" / "armwright"
        package.mkdir(parents=True)
        for file in pathlib.Path(armwright.__file__).parent.glob("*.py"):
            (package / file.name).write_text(file.read_text())
        command = [sys.executable, "-c", "import armwright"]
        for is_build_tree, piece in ((False, "cmake --build --preset release --target _armwright"),
                                     (True, f"cmake --build {self.folder} --target _armwright")):
            if is_build_tree:
                (self.folder / "CMakeCache.txt").touch()
            done = subprocess.run(command, env={**os.environ, "PYTHONPATH": str(package.parent)}, capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertIn("the compiled module _armwright is missing, because the Python package has not been built", done.stderr)
            self.assertIn(piece, done.stderr)
            self.assertNotIn("circular", done.stderr)

    def test_threads_and_slices_change_no_bit(self):
        alone = self.problem.evaluate(self.points, cases=3, jobs=1)
        for other in (self.problem.evaluate(self.points, cases=3, jobs=2), self.problem.evaluate(self.points.tolist(), cases=[0, 1, 2])):
            self.assertEqual(alone.objectives.tobytes(), other.objectives.tobytes())
            self.assertEqual(alone.case_errors.data.tobytes(), other.case_errors.data.tobytes())
        one = self.problem.evaluate(self.points[7], cases=[2])
        self.assertEqual(one.case_errors[0, 0], alone.case_errors[7, 2])
        self.assertEqual(alone.metrics["total_torque"].shape, (40,))
        self.assertTrue(np.allclose(alone.case_errors.mean(axis=1), alone.values))

    def test_agrees_with_a_run_of_the_programs(self):
        self.run_program(*"optimize q1-complex --engine articulated --optimizer random --schedule fixed:2 --budget 60 --quiet".split(), expect=3)
        history = armwright.load_run("results/q1-complex-random-seed1-engine_articulated-fixed2").history
        mine = self.problem.evaluate(history.x, cases=2)
        self.assertEqual(history.objectives.data.tobytes(), mine.objectives.tobytes())
        self.assertEqual(history.case_errors.data.tobytes(), mine.case_errors.data.tobytes())

    def test_a_matrix_in_order_is_not_copied_and_others_are_right(self):
        from armwright._values import to_points
        self.assertIs(to_points(self.points), self.points)
        transposed = np.asfortranarray(self.points)
        self.assertEqual(self.problem.evaluate(transposed, cases=1).values.tobytes(), self.problem.evaluate(self.points, cases=1).values.tobytes())

    def test_refuses_what_are_no_points(self):
        bad = self.points.copy()
        bad[3, 2] = np.nan
        outside = self.points.copy()
        outside[1, 0] = self.problem.upper[0] * 2
        for points, pieces in ((np.zeros((2, 19)), ["(2, 19)", "(n, 20)"]), (np.zeros((2, 2, 20)), ["(2, 2, 20)"]),
                               (bad, ["X[3, 2] (joint_1.d) is nan"]),
                               (outside, ["X[1, 0] (joint_1.p)", "between", "clip()"]), (np.zeros((1, 20), complex), ["complex128"]),
                               (np.array([["a"] * 20]), ["must hold real numbers"])):
            with self.subTest(pieces), self.expect_error(armwright.UsageError, *pieces):
                self.problem.evaluate(points)
        with self.expect_error(ValueError, "cases is 0"):
            self.problem.evaluate(self.points, cases=0)
        with self.expect_error(armwright.UsageError, "set is 'tset'"):
            self.problem.evaluate(self.points, set="tset")
        with self.expect_error(armwright.UsageError, "jobs is 0"):
            self.problem.evaluate(self.points, jobs=0)
        self.assertEqual(self.problem.evaluate(self.problem.clip(outside), cases=1).ok.all(), True)

    def test_errors_are_the_programs(self):
        with self.expect_error(armwright.UsageError, "unknown problem 'q1-complx'; did you mean 'q1-complex'?"):
            armwright.load_problem("q1-complx")
        with self.expect_error(armwright.UsageError, "task.load_kg"):
            armwright.load_problem("q1-complex", set={"task.load_kg": -1})
        with self.expect_error(armwright.UsageError, "name is missing"):
            armwright.load_problem()
        self.assertTrue(issubclass(armwright.IoError, OSError) and issubclass(armwright.BadDataError, ValueError))

    def test_failures_have_a_status_and_no_nan(self):
        # Nothing is cut off in tests: controllers at their upper bounds throw the arm about until it diverges.
        problem = armwright.load_problem("q1-complex", set={**FAST, "physics.judging_engine": "articulated"})
        wild = np.vstack([problem.upper, problem.start])
        done = problem.evaluate(wild, set="test", cases=3)
        self.assertEqual(done.status[0], "diverged")
        self.assertEqual(done.ok.tolist(), [False, True])
        self.assertIn(0, done.reasons)
        for numbers in (done.objectives, done.values, done.constraints, done.case_errors.data, *(one.data for one in done.metrics.values())):
            self.assertFalse(np.isnan(numbers).any())
        self.assertTrue(done.case_errors.mask[0].any() and not done.case_errors.mask[1].any())
        self.assertTrue(np.isfinite(done.objectives).all())
        self.assertGreater(done.values[0], done.values[1])

    def test_residuals_and_derivatives(self):
        problem = armwright.load_problem("sphere", set={"function.dimension": 3})
        done = problem.evaluate(problem.start, residuals=True)
        self.assertAlmostEqual((done.residuals**2).sum(), done.values[0])
        with self.expect_error(armwright.UsageError, "has no jacobian"):
            problem.evaluate(problem.start, jacobian=True)
        done = self.problem.evaluate(self.problem.start, cases=1, residuals=True, jacobian=True)
        moved = self.problem.start.copy()
        step = 1e-6 * abs(moved[0])
        moved[0] += step
        difference = (self.problem.evaluate(moved, cases=1, residuals=True).residuals - done.residuals)[0] / step
        self.assertEqual(done.jacobian.shape, (1, done.residuals.shape[1], 20))
        # Forward differences: off by the step times the curvature, and by cancellation.
        self.assertLess(np.abs(difference - done.jacobian[0, :, 0]).max(), 1e-3 * np.abs(difference).max())

    def test_cases_are_those_of_the_program(self):
        self.run_program("testset", "export", "test/2", "--cases", "4", "--out", "cases.json")
        exported = np.array(json.loads((self.folder / "cases.json").read_text())["cases"])
        mine = self.problem.cases("test", 4)
        self.assertEqual(mine.shape, (4, 26, 3))
        self.assertEqual(mine.tobytes(), exported.tobytes())
        self.assertEqual(self.problem.cases("test", 1, first=3).tobytes(), exported[3:].tobytes())

    def check_design(self, mine, words):
        told = json.loads(self.run_program("evaluate", *words, "--json", "--quiet"))
        self.assertEqual(mine.summary, {**told["summary"], "design": mine.summary["design"]})
        self.assertEqual(mine.errors_m.tolist(), [one["mean_error_m"] for one in told["cases"]])
        self.assertEqual(mine.energies_j.tolist(), [one["energy_j"] for one in told["cases"]])
        self.assertEqual(mine.point_errors_m.tolist(), [one["point_error_m"] for one in told["cases"]])
        self.assertEqual(mine.status, [one["status"] for one in told["cases"]])

    def test_designs_are_judged_as_by_the_program(self):
        words = ["--problem", "q2-e6", "--engine", "articulated", "--cases", "12"]
        problem = armwright.load_problem("q2-e6", set={"physics.judging_engine": "articulated", **FAST})
        self.check_design(problem.evaluate_design("table-a10", cases=12), ["table-a10", *words])
        own = problem.cases("test/7", 12)
        (self.folder / "cases.json").write_text(json.dumps({"cases": own.tolist()}))
        self.check_design(problem.evaluate_design("table-a10", cases=own), ["table-a10", *words[:4], "--test-cases", "cases.json"])
        # A point is the same as the file that is written of it.
        x = problem.from_unit(problem.to_unit(problem.start) + 0.01)
        problem.write_design(x, "mine.toml")
        self.check_design(problem.evaluate_design(x, cases=12), ["mine.toml", *words])
        self.check_design(problem.evaluate_design("start", cases=12), ["start", *words])

    def test_refuses_cases_that_are_none(self):
        with self.expect_error(armwright.BadDataError, "case 0, point 1"):
            self.problem.evaluate_design("start", cases=np.zeros((1, 3, 3)))
        with self.expect_error(armwright.UsageError, "is an analytic function"):
            armwright.load_problem("sphere").evaluate_design("start")
        with self.expect_error(armwright.UsageError, "has no arm, so its test cases have no points"):
            armwright.load_problem("sphere").cases()

    def test_arms_of_the_users_own(self):
        problem = armwright.load_problem(robot="planar2")
        self.assertTrue(problem.is_arm)
        self.assertIn("planar2", problem.configuration["robot"]["urdf"])

    def test_interrupted(self):
        text = ("import armwright, numpy as np, sys\np = armwright.load_problem('q1-complex')\nprint('begun', flush=True)\n"
                "try:\n    p.evaluate(np.tile(p.start, (20000, 1)), cases=5)\nexcept KeyboardInterrupt:\n    print('interrupted')\n")
        child = subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, text=True)
        self.assertEqual(child.stdout.readline(), "begun\n")
        time.sleep(0.3)
        begin = time.monotonic()
        child.send_signal(signal.SIGINT)
        self.assertEqual(child.communicate(timeout=60)[0], "interrupted\n")
        self.assertLess(time.monotonic() - begin, 30)  # of minutes

    def test_progress_is_a_line_on_a_terminal_and_nothing_elsewhere(self):
        text = "import armwright, time\np = armwright.load_problem('sphere')\n" \
               "class Slow(armwright.Optimizer):\n    def minimize(self, evaluator, seed):\n        while not evaluator.stopped:\n" \
               "            time.sleep(0.1)\n            evaluator.evaluate(p.start)\n" \
               "armwright.optimize(p, Slow, budget=8, progress=SHOW)\n"
        for show, is_seen in (("None", True), ("False", False)):
            own, other = pty.openpty()
            subprocess.run([sys.executable, "-c", text.replace("SHOW", show)], stderr=other, check=True, cwd=tempfile.mkdtemp(dir=self.folder))
            os.set_blocking(own, False)
            try:
                seen = os.read(own, 100_000)
            except BlockingIOError:
                seen = b""
            self.assertEqual(b"training [" in seen, is_seen)
        self.assertEqual(subprocess.run([sys.executable, "-c", text.replace("SHOW", "None")], capture_output=True).stderr, b"")

    def test_progress_comes_on_the_thread_that_called(self):
        import threading
        seen = []
        problem = armwright.load_problem("q1-complex")
        problem.evaluate(np.tile(problem.start, (60, 1)), cases=2, progress=lambda state: seen.append((threading.get_ident(), state)))
        self.assertEqual({ident for ident, _ in seen}, {threading.get_ident()})
        self.assertEqual((seen[-1][1].done, seen[-1][1].total), (120, 120))
        with self.assertRaises(ZeroDivisionError):
            problem.evaluate(problem.start, cases=1, progress=lambda state: 1 / 0)


if __name__ == "__main__":
    unittest.main()
