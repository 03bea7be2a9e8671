"""Runs from Python: the program's results bit for bit, and classes of Python's as optimizers like any other."""
import json
import pathlib
import signal
import subprocess
import sys
import time
import unittest
import warnings

import numpy as np
from support import FAST, FolderTest, Steps, read_bytes

import armwright

SMALL = {"function.dimension": 3}


class Faulty(Steps):
    name = "faulty"
    breaks = True

    def minimize(self, evaluator, seed):
        evaluator.evaluate(evaluator.problem.start)
        if self.breaks:
            raise ZeroDivisionError("my mistake")


class Generations(armwright.Optimizer):
    """Draws three points a generation, and recommends the middle."""

    capabilities = ("generations", "residuals", "stochastic", "sampling", "bounds", "batch")

    def minimize(self, evaluator, seed):
        random = np.random.default_rng(seed)
        while not evaluator.stopped:
            evaluator.begin_generation()
            shares = random.random((3, len(evaluator.problem)))
            scores = evaluator.evaluate(evaluator.problem.from_unit(shares))
            assert scores.residuals is None or scores.residuals.shape[0] == len(scores)
            evaluator.recommend(evaluator.problem.from_unit(shares.mean(axis=0)))


class Late(armwright.Optimizer):
    """Recommends the origin after the budget has ended."""

    requirements = {"variables": 2}
    is_early = False

    def minimize(self, evaluator, seed):
        evaluator.evaluate(evaluator.problem.start)
        if self.is_early:
            return "all is seen"
        while not evaluator.stopped:
            evaluator.evaluate(evaluator.problem.start)
        evaluator.recommend(np.zeros(len(evaluator.problem)))
        return 0  # not a text: nothing is said


class Early(Late):
    is_early = True


class Idle(armwright.Optimizer):
    def minimize(self, evaluator, seed):
        return "no licence"


class RunTest(FolderTest):
    def test_a_recommendation_after_the_budget_wins(self):
        run = armwright.optimize("sphere", Late, budget=10, out="late")
        self.assertEqual((run.counts["evaluations"], run.end_reason, run.unused_evaluations), (10, "budget", 0))
        self.assertEqual(run.x.tolist(), [0.0] * len(run.x))

    def test_an_early_end_says_why_and_what_is_left(self):
        run = armwright.optimize("sphere", Early, budget=10, out="early")
        self.assertEqual((run.end_reason, run.end_detail, run.unused_evaluations), ("optimizer finished", "all is seen", 9))
        run = armwright.optimize("sphere", Idle, budget=10, out="idle")
        self.assertEqual(run.end_reason, "optimizer failed")
        self.assertIn("returned without evaluating a point, although the budget pays for 10; its reason: no licence", run.failure)

    def test_requirements_refuse_a_problem_that_is_too_small(self):
        with self.expect_error(armwright.UsageError, "cannot work on sphere"):
            armwright.optimize("sphere", Late, set={"function.dimension": 1}, budget=10)

        class Unknown(Late):
            requirements = {"objective": 2}

        with self.expect_error(armwright.UsageError, "'objective'", "objectives, variables, residuals"):
            armwright.optimize("sphere", Unknown, budget=10)

    def test_same_bytes_as_the_program(self):
        for problem, optimizer, settings, flags in (("q1-complex", "cmaes", FAST, ["--engine", "articulated"]),
                                                    ("q2-pareto", "pagmo:nsga2", FAST, ["--engine", "articulated"]),
                                                    ("sphere", "nlopt:cobyla", SMALL, ["--set", "function.dimension=3"])):
            with self.subTest(optimizer):
                mine = armwright.optimize(problem, optimizer, seed=5, budget=120, set=settings, out="mine-" + optimizer)
                self.run_program("optimize", problem, *flags, "--optimizer", optimizer, "--out", "its-" + optimizer,
                                 *"--seed 5 --budget 120 --quiet".split())
                self.assertEqual(read_bytes(mine.folder, "result.json"), read_bytes("its-" + optimizer, "result.json"))
                self.assertEqual(mine.to_dict(), armwright.load_run("its-" + optimizer).to_dict())
                # The same command goes on with the run, and finds it complete.
                words = mine.manifest["command_line"]
                self.run_program(*words[1:], "--quiet")

    def test_importance_is_what_the_program_shows(self):
        problem = armwright.load_problem("ellipsoid", set={"function.dimension": 3, "function.instance": 0})
        run = armwright.optimize(problem, "random", budget=300, schedule="fixed:1", out="run")
        found = run.importance()
        self.assertEqual(found, json.loads(self.run_program("show", "run", "--importance", "--json")))
        self.assertEqual([part["region"] for part in found["parts"]], ["winner", "run"])
        self.assertGreater(found["parts"][1]["variables"][2]["total"]["value"], 0.9)
        self.assertEqual(run.importance(100)["parts"][0]["region"], "design")
        with self.assertRaisesRegex(armwright.UsageError, "needs at least 40"):
            run.importance(39)

    def test_options_schedule_and_default_folder(self):
        run = armwright.optimize("q1-complex", "ga", seed=2, budget=70, set=FAST, options={"population": 7, "mutation_probability": 0.25},
                                 schedule="fresh:2", jobs=1)
        self.assertRegex(str(run.folder), "^results/q1-complex-ga-seed2-[0-9a-f]{8}$")
        self.assertEqual(run.manifest["configuration"]["run"]["options"]["population"], 7)
        self.run_program(*"optimize q1-complex --engine articulated --optimizer ga --seed 2 --budget 70 --opt population=7".split(),
                         *"--opt mutation_probability=0.25 --schedule fresh:2 --out its --quiet".split(), expect=3)
        self.assertEqual(read_bytes(run.folder, "result.json"), read_bytes("its", "result.json"))
        history = run.history
        self.assertEqual(history.generation.tolist(), [1] * 7 + [2] * 7 + [3] * 7 + [4] * 7 + [5] * 7)
        self.assertEqual(history.case_numbers[7].tolist(), [2, 3])
        self.assertEqual(int(history.charge.sum()), run.counts["cases"])
        self.assertIn(run.x.tolist(), [one["x"] for one in run.candidates])
        another = armwright.optimize("q1-complex", "ga", seed=2, budget=70, set=FAST, new=True)
        self.assertEqual(another.folder.name, "q1-complex-ga-seed2-engine_articulated")

    def test_refusals_are_the_programs(self):
        for kind, pieces, call in (
                (armwright.UsageError, ["unknown optimizer 'cmae'", "cmaes"], lambda: armwright.optimize("sphere", "cmae")),
                (armwright.UsageError, ["option 'populaton'", "population"], lambda: armwright.optimize("sphere", "ga", options={"populaton": 3})),
                (armwright.UsageError, ["seed is -1"], lambda: armwright.optimize("sphere", "ga", seed=-1)),
                (armwright.UsageError, ["budget is -5"], lambda: armwright.optimize("sphere", "ga", budget=-5)),
                (armwright.UsageError, ["schedule is 'some'", "fixed:K"], lambda: armwright.optimize("sphere", "ga", schedule="some")),
                (armwright.UsageError, ["the optimizer is 3"], lambda: armwright.optimize("sphere", 3)),
                (armwright.UsageError, ["runs only there", "armwright.serve"], lambda: armwright.optimize("sphere", "python:steps")),
                (armwright.UsageError, ["is not the folder of a run"], lambda: armwright.load_run("nowhere")),
                (armwright.UsageError, ["progress is 3"], lambda: armwright.optimize("sphere", "ga", progress=3))):
            with self.subTest(pieces), self.expect_error(kind, *pieces):
                call()
        armwright.optimize("sphere", "ga", budget=10, out="there")
        with self.expect_error(armwright.UsageError, "run.seed: recorded 1, now 2"):
            armwright.optimize("sphere", "ga", budget=10, seed=2, out="there")

    def test_a_class_runs_resumes_and_is_read_by_the_program(self):
        run = armwright.optimize("q1-complex", Steps, seed=3, budget=100, set=FAST, options={"batch": 6}, out="mine", jobs=2)
        self.assertEqual((run.optimizer, run.end_reason, run.counts["cases"]), ("python:steps", "budget", 100))
        alone = armwright.optimize("q1-complex", Steps, seed=3, budget=100, set=FAST, options={"batch": 6}, out="alone", jobs=1)
        self.assertEqual(read_bytes("mine", "result.json"), read_bytes("alone", "result.json"))
        self.assertEqual(run.manifest["configuration"]["run"]["options"], {"batch": 6, "spread": 0.2})
        self.assertEqual(json.loads(self.run_program("show", "mine", "--json", expect=3)), run.to_dict())
        self.run_program("export", "mine", "--format", "csv", "--out", "csv")
        self.assertIn("python:steps", self.run_program("show", "mine", expect=3))
        with self.expect_error(armwright.UsageError, "option 'batch' is '0'; it must be an integer between 1 and 100"):
            armwright.optimize("q1-complex", Steps, options={"batch": 0})

    def test_keeps_every_promise(self):
        for cls in (Steps, Generations):
            found = armwright.check_optimizer(cls)
            self.assertEqual([one for one in found if one.outcome == "broken"], [])
            self.assertGreater(sum(one.outcome == "held" for one in found), 8)

        class Forgetful(Steps):
            def minimize(self, evaluator, seed):
                super().minimize(evaluator, np.random.SeedSequence().entropy)

        self.assertIn("Repeatable", [one.check for one in armwright.check_optimizer(Forgetful) if one.outcome == "broken"])

    def test_types_of_variables_are_given_to_those_who_declare_them(self):
        seen = set()

        class Typed(armwright.Optimizer):
            capabilities = ("bounds", "integer", "categorical")

            def minimize(self, evaluator, seed):
                seen.update(variable.type for variable in evaluator.problem.variables)
                evaluator.evaluate(evaluator.problem.clip(evaluator.problem.start + 0.3))

        self.assertEqual({one.check: one.outcome for one in armwright.check_optimizer(Typed)}["Types"], "held")
        self.assertEqual(seen, {"real", "integer", "category"})
        seen.clear()
        Typed.capabilities = ("bounds",)
        self.assertEqual({one.check: one.outcome for one in armwright.check_optimizer(Typed)}["Types"], "exempt")
        self.assertEqual(seen, {"real"})

    def test_generations_residuals_and_recommendations(self):
        run = armwright.optimize("sphere", Generations, budget=30, set=SMALL)
        self.assertEqual(run.counts["generations"], 10)
        self.assertTrue(any(one.get("recommended") for one in run.candidates))
        fresh = armwright.optimize("q1-complex", Generations, budget=30, set=FAST, schedule="fresh:1", out="fresh")
        self.assertEqual(fresh.history.case_numbers[:, 0].tolist(), [number for number in range(10) for _ in range(3)])

    def test_stopped_by_time_and_gone_on_with(self):
        class Slow(Steps):
            name = "slow"

            def minimize(self, evaluator, seed):
                while not evaluator.stopped:
                    time.sleep(0.02)
                    evaluator.evaluate(evaluator.problem.start)

        begun = armwright.optimize("sphere", Slow, budget=30, set=SMALL, out="slow", time_limit_s=0.1)
        self.assertFalse(begun.finished)
        self.assertIsNone(begun.x)
        self.assertLess(len(begun.history), 30)
        done = armwright.optimize("sphere", Slow, budget=30, set=SMALL, out="slow")
        self.assertEqual(len(done.history), 30)
        Slow.pause_s = 0.03
        with self.expect_error(armwright.UsageError, "the input 'class", "recorded", "Slow"):
            armwright.optimize("sphere", Slow, budget=30, set=SMALL, out="slow")

    def test_objects_are_copied_and_their_attributes_recorded(self):
        mine = Steps()
        mine.note = np.array([1.0, 2.0])
        first = armwright.optimize("sphere", mine, budget=20, set=SMALL, out="object")
        self.assertFalse(hasattr(mine, "settings"))
        mine.note = np.array([1.0, 3.0])
        with self.expect_error(armwright.UsageError, "the input 'attributes of the Steps' has changed"):
            armwright.optimize("sphere", mine, budget=20, set=SMALL, out="object")
        mine.note = np.random.default_rng(1)
        with self.expect_error(armwright.UsageError, "an attribute of the Steps is a Generator"):
            armwright.optimize("sphere", mine, budget=20, set=SMALL, out="object")
        self.assertEqual(first.counts["cases"], 20)

    def test_classes_that_do_not_hold_together(self):
        class Nothing(armwright.Optimizer):
            pass

        class Wrong(Steps):
            capabilities = ["bound"]

        class Blank(Steps):
            name = "a b"

        class Range(Steps):
            options = [armwright.Option("batch", 4, lower=5, upper=6)]

        for cls, kind, piece in ((Nothing, armwright.UsageError, "has no minimize"), (Wrong, armwright.UsageError, "capability 'bound'"),
                                 (Blank, armwright.BadDataError, "named 'a b'"), (Range, armwright.BadDataError, "outside its range")):
            with self.subTest(piece), self.expect_error(kind, piece):
                armwright.optimize("sphere", cls)

    def test_an_exception_is_a_failure_and_is_tried_again(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            run = armwright.optimize("sphere", Faulty, budget=10, set=SMALL, out="faulty")
        self.assertEqual(run.end_reason, "optimizer failed")
        self.assertIn("optimizer 'python:faulty', after 1 evaluation: it raised ZeroDivisionError: my mistake (run_test.py, line ", run.failure)
        self.assertEqual(caught[0].category, armwright.ArmwrightWarning)
        self.assertIn('raise ZeroDivisionError("my mistake")', str(caught[0].message))
        self.assertEqual(len(run.history), 1)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            again = armwright.optimize("sphere", Faulty, budget=10, set=SMALL, out="faulty")
        self.assertEqual(again.to_dict(), run.to_dict())

    def test_points_that_are_none_are_its_failure(self):
        class Crooked(Steps):
            def minimize(self, evaluator, seed):
                evaluator.evaluate(np.full((1, len(evaluator.problem)), np.inf))

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self.assertIn("X[0, 0] (x_1) is inf; it must be a finite number", armwright.optimize("sphere", Crooked, set=SMALL).failure)

    def test_what_the_evaluator_throws_is_no_failure_of_the_optimizer(self):
        class Stubborn(Steps):
            name = "stubborn"

            def minimize(self, evaluator, seed):
                try:
                    evaluator.evaluate(evaluator.problem.start + self.settings["spread"])
                except Exception:  # whoever swallows it does not get away with it
                    pass

        armwright.optimize("sphere", Stubborn, budget=5, set=SMALL, out="stubborn")
        # The same name, class and options, but other points: what is recorded no longer fits.
        Stubborn.minimize.__code__ = (lambda self, evaluator, seed: evaluator.evaluate(evaluator.problem.start)).__code__
        manifest = json.loads((self.folder / "stubborn/manifest.json").read_text())
        from armwright.optimizer import read_optimizer
        manifest["configuration"]["inputs"].update(read_optimizer(Stubborn).hashes)
        (self.folder / "stubborn/manifest.json").write_text(json.dumps(manifest))
        (self.folder / "stubborn/SHA256SUMS").unlink()  # else the changed manifest is refused
        (self.folder / "stubborn/result.json").unlink()
        with self.expect_error(armwright.BadDataError, "evaluation 0 of the journal is not what optimizer 'python:stubborn' asks for now"):
            armwright.optimize("sphere", Stubborn, budget=5, set=SMALL, out="stubborn")

    def test_an_evaluator_is_of_no_use_after_its_run(self):
        kept = []

        class Keeper(Steps):
            def minimize(self, evaluator, seed):
                kept.append(evaluator)

        armwright.optimize("sphere", Keeper, budget=5, set=SMALL)
        with self.expect_error(armwright.UsageError, "the run of this evaluator is over"):
            kept[0].evaluate([0.0, 0.0, 0.0])

    def test_what_a_callable_raises_stops_the_run_resumably(self):
        def refuse(state):
            raise RuntimeError("seen enough")

        with self.assertRaisesRegex(RuntimeError, "seen enough"):
            armwright.optimize("q1-complex", "cmaes", budget=3000, set=FAST, out="refused", progress=refuse)
        self.assertEqual(armwright.optimize("q1-complex", "cmaes", budget=100, set=FAST, out="other").counts["cases"], 100)

    def test_interrupted_and_gone_on_with(self):
        for optimizer in ("Steps", "'cmaes'", "'nlopt:cobyla'"):
            with self.subTest(optimizer):
                script = ("import armwright\nfrom support import Steps\n"
                          f"def go(): return armwright.optimize('q1-complex', {optimizer}, budget=BUDGET, out=OUT, jobs=2)\n")
                out = "interrupted-" + optimizer.strip("'")
                text = script + "print('begun', flush=True)\ntry: go()\nexcept KeyboardInterrupt as stop: print(stop)\n"
                text = text.replace("BUDGET", "60000").replace("OUT", repr(out))
                child = subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, text=True)
                child.stdout.readline()
                journal = pathlib.Path(out, "journal")
                while not journal.is_file() or journal.stat().st_size < 5000:
                    time.sleep(0.02)
                child.send_signal(signal.SIGINT)
                self.assertIn("the same call of armwright.optimize() goes on", child.communicate(timeout=60)[0])
                begun = armwright.load_run(out)
                self.assertFalse(begun.finished)
                self.assertGreater(len(begun.history), 0)
                self.assertIn("is not complete", self.run_program("show", out))


if __name__ == "__main__":
    unittest.main()
