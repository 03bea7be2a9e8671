"""Problems that are Python classes: their answers, their failures, and the same results in this process, in workers and as a program."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import time
import unittest

import numpy as np
from support import FolderTest, read_bytes

import armwright


class Bowl(armwright.UserProblem):
    """A bowl"""

    variables = [armwright.Real("a", -5, 5, unit="m"), armwright.Real("b", 0.1, 10, scale="logarithmic")]
    objectives = ["f"]

    def evaluate(self, x, case):
        if x[0] > 4.5:
            raise ValueError(f"too far: {object()}")
        return float("nan") if x[0] > 4.3 else ((x - 1) ** 2).sum()


class Mixed(armwright.UserProblem):
    variables = [armwright.Real("a", -5, 5), armwright.Integer("n", -4, 9), armwright.Category("kind", ["round", "steep"])]
    constraints = [armwright.Constraint("c", "m", limit=3)]
    metrics = ["m"]
    cases = {"training": 0, "validation": 3, "test": 4}

    def evaluate(self, x, case):
        assert [type(value) for value in x.values()] == [float, int, str]
        noise = np.random.default_rng(case.seed).normal()
        return {"objective": x["a"] ** 2 + (x["n"] - 2) ** 2 + 3 * (x["kind"] == "steep") + 0.1 * noise, "c": abs(x["a"]), "m": x["n"]}


class Crashing(Bowl):
    isolate = True
    time_limit_s = 1.0

    def evaluate(self, x, case):
        if x[0] > 4:
            os._exit(3)
        if x[0] > 3:
            os.kill(os.getpid(), signal.SIGSEGV)
        if x[0] > 2:
            time.sleep(600)
        if x[0] < -4:
            sys.exit("bye")
        return float(x[0] ** 2)


class Batch(Bowl):
    def evaluate_batch(self, points, cases):
        assert len(points) == len(cases)
        return ((points - 1) ** 2).sum(axis=1)


class Other(Bowl):
    returned = None

    def evaluate(self, x, case):
        return self.returned


SCRIPT = """import sys
sys.path.insert(0, {tests!r})
import armwright
from user_problem_test import Bowl, Mixed

class Slow(Bowl):  # a class of __main__, as in a notebook
    def evaluate(self, x, case):
        import time
        time.sleep(0.002)
        print("evaluated")
        return super().evaluate(x, case)

if sys.argv[1] == "serve":
    armwright.serve(Mixed)
else:
    armwright.optimize(Slow, sys.argv[1], budget=300, out=sys.argv[2], jobs=int(sys.argv[3]))
"""


class UserProblemTest(FolderTest):
    def setUp(self):
        super().setUp()
        pathlib.Path("mine.py").write_text(SCRIPT.format(tests=str(pathlib.Path(__file__).resolve().parent)))

    def test_a_case_that_raises_or_has_no_number_fails_with_the_reason(self):
        for jobs in (1, 2):
            found = armwright.load_problem(Bowl).evaluate([[1, 1], [4.6, 1], [4.4, 1]], jobs=jobs)
            self.assertEqual(found.reasons, {1: "ValueError: too far: <object object at 0x...>", 2: "its objective 'f' is not a finite number"})
            self.assertEqual(found.values[0], 0)

    def test_a_worker_that_crashes_or_hangs_costs_one_case(self):
        points = [[4.5, 1], [3.5, 1], [2.5, 1], [-4.5, 1], [0.5, 1]]
        found = armwright.load_problem(Crashing).evaluate(points, jobs=1)
        self.assertEqual(found.status.tolist(), ["failed", "failed", "timed out", "failed", "ok"])
        for row, piece in enumerate(["exit code 3", "signal 11", "1 s", "SystemExit: bye"]):
            self.assertIn(piece, found.reasons[row])
        self.assertEqual(found.values[4], 0.25)

    def test_an_answer_that_breaks_the_contract_ends_the_call(self):
        for returned, piece in (([1, 2], '"metrics"'), (None, "NoneType"), ("abc", "abc"), ({"g": 1}, "a dict without 'f'"),
                                (armwright.Answer([1, 2]), '"objectives"')):
            problem = Other()
            problem.returned = returned
            with self.expect_error(armwright.BadDataError, "python:Other", piece):
                armwright.load_problem(problem).evaluate([1, 1], jobs=1)

    def test_a_failure_may_be_returned(self):
        problem = Other()
        problem.returned = armwright.Failed("out of reach", "unreachable")
        found = armwright.load_problem(problem).evaluate([1, 1])
        self.assertEqual((found.status[0], found.reasons[0]), ("unreachable", "out of reach"))

    def test_a_batch_gives_what_single_points_give(self):
        points = np.random.default_rng(1).uniform(0.1, 4, (50, 2))
        single, batch = (armwright.load_problem(one).evaluate(points).values for one in (Bowl, Batch))
        self.assertEqual(single.tolist(), batch.tolist())

    def test_a_function_is_a_problem_in_one_line(self):
        problem = armwright.make_problem(lambda x: (x["n"] - 3) ** 2 + (x["w"] == "b"), [-5, 0], [5, 0], names=["n", "w"],
                                         types=["integer", ["a", "b"]], name="line")
        run = armwright.optimize(problem, "random", budget=200, out="line")
        self.assertEqual(run.x.tolist(), [3, 0])

    def test_a_wrong_description_is_refused(self):
        with self.expect_error(armwright.UsageError, "python:f", "variables[0].lower", "less than upper"):
            armwright.load_problem(armwright.make_problem(abs, [1], [0], name="f"))
        with self.expect_error(armwright.UsageError, "no evaluate"):
            armwright.load_problem(armwright.UserProblem)

    def test_results_depend_neither_on_jobs_nor_on_the_way(self):
        for jobs in (1, 2):
            armwright.optimize(Mixed, "ga", budget=200, out=f"jobs{jobs}", jobs=jobs)
        self.run_program("optimize", f"exec:{sys.executable} mine.py serve", "--optimizer", "ga", "--budget", "200", "--out", "exec", "--quiet")
        mine, its = (armwright.load_run(one).history for one in ("jobs1", "exec"))
        self.assertEqual(read_bytes("jobs1/result.json"), read_bytes("jobs2/result.json"))
        self.assertEqual((mine.x.tobytes(), mine.objectives.tobytes()), (its.x.tobytes(), its.objectives.tobytes()))

    def test_a_killed_run_goes_on_to_the_same_bytes(self):
        for optimizer in ("ga", "cmaes"):
            for jobs in "12":
                folder = pathlib.Path(f"{optimizer}{jobs}")
                words = [sys.executable, "mine.py", optimizer, str(folder), jobs]
                with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as run:
                    while run.poll() is None and not ((folder / "journal").exists() and (folder / "journal").stat().st_size > 3000):
                        time.sleep(0.005)
                    run.kill()
                self.assertFalse((folder / "result.json").exists())
                for where in (str(folder), f"whole-{folder}"):
                    subprocess.run([*words[:3], where, jobs], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                self.assertEqual(read_bytes(folder, "result.json"), read_bytes(f"whole-{folder}", "result.json"))

    def test_an_interrupted_run_goes_on_to_the_same_bytes(self):
        for optimizer in ("ga", "nlopt:cobyla", "pagmo:de"):
            for jobs in "12":
                folder = pathlib.Path(f"{optimizer.replace(':', '-')}{jobs}")
                words = [sys.executable, "mine.py", optimizer, str(folder), jobs]
                with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True) as run:
                    while run.poll() is None and not ((folder / "journal").exists() and (folder / "journal").stat().st_size > 3000):
                        time.sleep(0.005)
                    os.killpg(run.pid, signal.SIGINT)  # as a terminal does: the workers get it, too
                    message = run.communicate(timeout=60)[1]
                self.assertIn("KeyboardInterrupt: interrupted; all evaluations so far are recorded", message)
                self.assertFalse((folder / "result.json").exists())
                for where in (str(folder), f"whole-{folder}"):
                    subprocess.run([*words[:3], where, jobs], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                self.assertEqual(read_bytes(folder, "result.json"), read_bytes(f"whole-{folder}", "result.json"), folder)

    def test_a_changed_problem_is_not_continued(self):
        problem = Other()
        for problem.returned in (1.0, 2.0):
            if problem.returned == 1.0:
                armwright.optimize(problem, "random", budget=5, out="run")
            else:
                with self.assertRaises(armwright.Error):
                    armwright.optimize(problem, "random", budget=5, out="run")

    def test_a_comparison_ends_with_a_verdict(self):
        for jobs in (1, 2):
            armwright.compare([Bowl, Mixed()], ["ga", "cmaes"], replicates=2, budget=40, out=f"study{jobs}", jobs=jobs)
        self.assertEqual(read_bytes("study1/result.json"), read_bytes("study2/result.json"))
        self.assertIn("Verdict", self.run_program("show", "study1"))

    def test_curves_and_files_follow_the_protocol(self):
        class Curve(Bowl):
            def record(self, x, case):
                return armwright.Record(("time", "s", [0, 1]), [("f", "m", x)], {"note.txt": "hello", "raw.bin": b"\0\1"})

        from armwright.user_problem import PythonProblem
        sent = []
        PythonProblem(Curve).answer('{"type":"record","id":4,"role":"test","set":"test/1","points":[[1.0,2.0]],"cases":[0]}', sent.append)
        message = json.loads(sent[0])
        self.assertEqual(message["series"], [{"name": "f", "unit": "m", "values": [1.0, 2.0]}])
        self.assertEqual([one["name"] for one in message["files"]], ["note.txt", "raw.bin"])


if __name__ == "__main__":
    unittest.main()
