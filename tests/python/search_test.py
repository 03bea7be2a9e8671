"""Ask and tell from Python: the run is that of optimize(), whatever the order of the results."""
import pathlib
import unittest

import numpy as np

import armwright
from support import FolderTest

BENCH = """kind = "external"
[[variable]]
name = "gain"
lower = 0
upper = 4
[[variable]]
name = "steps"
type = "integer"
lower = 1
upper = 6
[[variable]]
name = "oil"
type = "category"
choices = ["thin", "thick"]
[[objective]]
name = "error"
[[constraint]]
name = "heat"
limit = 9
"""


class Bowl(armwright.UserProblem):
    variables = [armwright.Real("a", -5, 5, start=3), armwright.Real("b", -5, 5, start=-2)]

    def evaluate(self, x, case):
        return float(((x - 1) ** 2).sum())


class Untouched(Bowl):
    name = "Bowl"

    def evaluate(self, x, case):
        raise AssertionError("a search evaluates nothing")


def measure(x):
    return {"error": (x["gain"] - 1) ** 2 + (x["steps"] - 2) ** 2 + (x["oil"] == "thin"), "heat": x["gain"] + x["steps"]}


class SearchTest(FolderTest):
    def finish(self, search, value, n=None):
        for _ in range(500):
            points = search.ask(n)
            if not points and not search.waiting:
                break
            for point in reversed(search.waiting if not points else points):
                search.tell(point, value(point.x))
        self.assertTrue(search.finished)
        return search.result()

    def test_the_result_is_that_of_optimize(self):
        bowl = Bowl()
        for optimizer in ("cmaes", "random"):
            simulated = armwright.optimize(Bowl, optimizer, budget=40, out=f"run-{optimizer}")
            told = self.finish(armwright.Search(Untouched, optimizer, budget=40, out=f"told-{optimizer}"), lambda x: bowl.evaluate(x, None), 4)
            self.assertEqual(told.history.x.tobytes(), simulated.history.x.tobytes())
            self.assertEqual(told.history.objectives.tobytes(), simulated.history.objectives.tobytes())

    def test_a_file_with_words_and_integers(self):
        pathlib.Path("bench.toml").write_text(BENCH)
        search = armwright.Search("bench.toml", "cmaes", budget=60, out="bench")
        point = search.ask(1)[0]
        self.assertEqual([type(point.x[name]) for name in ("gain", "steps", "oil")], [float, int, str])
        search.tell(point.id, armwright.Answer([1.0], [2.0]))
        run = self.finish(search, measure)
        self.assertLess(run.value, 2)
        self.assertEqual(search.ask(), [])
        self.assertIn("error", self.run_program("show", "bench"))

    def test_another_search_goes_on_and_no_point_comes_twice(self):
        first = armwright.Search(Bowl, "ga", budget=30, options={"population": 6}, out="run")
        ids = [point.id for point in first.ask(2)]
        first.tell(ids[1], missing="the fuse blew")
        second = armwright.Search(Bowl, "ga", budget=30, options={"population": 6}, out="run")
        self.assertEqual([point.id for point in second.waiting], ids[:1])
        self.assertFalse(set(ids) & {point.id for point in second.ask()})
        self.assertEqual(second.ask(), [])
        self.assertFalse(second.result().finished)
        self.finish(second, lambda x: float(x @ x))
        self.assertEqual(second.result().history.status[ids[1]], "failed")

    def test_wrong_results_are_refused_and_not_recorded(self):
        search = armwright.Search(Bowl, "cmaes", budget=30, out="run")
        point = search.ask(1)[0]
        for value in (float("nan"), [1.0, 2.0], "high", {"mistake": 1}, [np.inf]):
            with self.assertRaises(armwright.Error, msg=str(value)):
                search.tell(point, value)
        with self.expect_error(armwright.UsageError, "either its value, or missing="):
            search.tell(point)
        with self.expect_error(armwright.UsageError, "point 7 was never handed out"):
            search.tell(7, 1.0)
        search.tell(point, 1)
        with self.expect_error(armwright.UsageError, "has a result already"):
            search.tell(point, 1)
        self.assertEqual(len(armwright.load_run("run").history), 1)

    def test_what_cannot_be_asked_for_is_refused(self):
        with self.expect_error(armwright.UsageError, "optimize() runs it"):
            armwright.Search("sphere", "cmaes")
        with self.expect_error(armwright.UsageError, "n is 0"):
            armwright.Search(Bowl, "cmaes", out="run").ask(0)
        pathlib.Path("bench.toml").write_text(BENCH)
        with self.expect_error(armwright.UsageError, "armwright ask"):
            armwright.optimize("bench.toml", "cmaes", budget=10)


if __name__ == "__main__":
    unittest.main()
