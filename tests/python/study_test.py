"""Comparisons from Python: the program's tables byte for byte, and classes of Python's in rows beside all others."""
import json
import pathlib
import signal
import subprocess
import sys
import time
import unittest

import numpy as np
from support import FolderTest, PROGRAM, Steps, read_bytes

import armwright

SMALL = {"function.dimension": 3}


class Stepsize(Steps):
    name = "local-steps"
    capabilities = ("bounds", "batch", "stochastic", "local")


def compare(**changes):
    asked = dict(problems=["sphere", "rosenbrock"], optimizers=["ga", Steps], replicates=6, budget=60, set=SMALL, out="study")
    return armwright.compare(**{**asked, **changes})


class StudyTest(FolderTest):
    def test_same_bytes_as_the_program(self):
        mine = compare(optimizers=["ga", "cmaes"])
        self.run_program(*"compare --problems sphere,rosenbrock --optimizers ga,cmaes --replicates 6 --budget 60 --out its --quiet".split(),
                         "--set", "function.dimension=3")
        for file in ("study.toml", "result.json", "verdict.txt", "tables/curves.csv"):
            self.assertEqual(read_bytes(mine.folder, file), read_bytes("its", file), file)
        its = armwright.load_study("its")
        self.assertEqual(its.to_dict(), mine.to_dict())
        self.assertEqual(mine.to_dict(), json.loads(read_bytes("its", "result.json")))

    def test_a_class_has_a_row_that_the_program_reads(self):
        study = compare(jobs=2)
        self.assertEqual(study.optimizers, ("ga", "python:steps", "start", "random", "nlopt:neldermead"))
        self.assertEqual(study.baselines, {"start", "random", "nlopt:neldermead"})
        self.assertTrue(study.finished)
        self.assertEqual(study.values.shape, (5, 2, 6))
        self.assertTrue(np.isfinite(study.values).all())
        self.assertEqual(len({tuple(row) for row in study.start_values[:, 0].tolist()}), 1)  # the same for all
        curves = study.curves("sphere", "python:steps")
        self.assertEqual(curves.shape, (6, len(study.checkpoints("sphere"))))
        self.assertTrue((np.diff(curves, axis=1) <= 0).all())
        self.assertEqual(study.run("sphere", "python:steps", 2).value, study.values[1, 0, 1])
        self.assertEqual(study.cell("sphere", "python:steps", 2)["value"], study.values[1, 0, 1])
        self.assertEqual(len(study.pairs("sphere")), 10)
        self.assertEqual(set(study.table("sphere")), set(study.optimizers))
        self.assertEqual(set(study.mean_ranks), set(study.optimizers))
        self.assertEqual("\n".join(study.verdict) + "\n", read_bytes("study/verdict.txt").decode())
        with self.expect_error(armwright.UsageError, "unknown problem of the study 'sphre'"):
            study.curves("sphre", "ga")
        # The program reads it, and makes the same of it.
        self.assertEqual(json.loads(self.run_program("show", "study", "--json")), study.to_dict())
        self.run_program("export", "study", "--format", "csv", "--out", "csv")
        self.run_program("report", "study", "--out", "page.html")
        self.run_program("doctor", "study")
        # And says where the class lives, when asked to run it.
        told = subprocess.run([PROGRAM, "rerun", "study", "sphere/python:steps/r01"], capture_output=True, text=True)
        self.assertIn("is a class in somebody's Python program, and runs only there", told.stderr)
        self.assertNotEqual(told.returncode, 0)
        # Threads change nothing.
        self.assertEqual(read_bytes("study/result.json"), read_bytes(compare(out="alone", jobs=1).folder, "result.json"))

    def test_grows_and_notices_a_changed_class(self):
        before = compare(replicates=6, problems=["sphere"], optimizers=[Stepsize])
        self.assertEqual(before.optimizers, ("python:local-steps", "start", "random"))  # it is a local search itself
        self.assertEqual(armwright.load_study("study").optimizers, before.optimizers)
        after = compare(replicates=7, problems=["sphere"], optimizers=[Stepsize, "cmaes"])
        self.assertEqual(after.values[0, 0, :6].tolist(), before.values[0, 0].tolist())
        self.assertEqual(after.optimizers[:2], ("python:local-steps", "cmaes"))

        class Changed(Stepsize):
            extra = 1

        with self.expect_error(armwright.UsageError, "optimizer python:local-steps: inputs"):
            compare(replicates=7, problems=["sphere"], optimizers=[Changed, "cmaes"])

    def test_study_files_and_refusals(self):
        pathlib.Path("mine.toml").write_text('problems = ["sphere"]\noptimizers = ["ga"]\nreplicates = 2\nbudget = 30\n'
                                             'set = ["function.dimension=2"]\n')
        study = armwright.compare(study="mine.toml")
        self.assertEqual((study.folder, study.replicates), (pathlib.Path("results/mine"), 2))
        self.assertEqual(armwright.compare(study="mine.toml", replicates=3).values.shape, (4, 1, 3))
        for pieces, call in ((["nothing to compare"], lambda: armwright.compare()),
                             (["problems is the text 'sphere'"], lambda: armwright.compare("sphere", ["ga"])),
                             (["must hold names, files or problems of your own"], lambda: armwright.compare([armwright.load_problem("sphere")], ["ga"])),
                             (["two optimizers of the study are called 'python:steps'"], lambda: compare(optimizers=[Steps, Steps])),
                             (["names no budget"], lambda: armwright.compare(["sphere"], ["ga"])),
                             (["replicates is 0"], lambda: compare(replicates=0)),
                             (["there is no folder 'nowhere'"], lambda: armwright.load_study("nowhere"))):
            with self.subTest(pieces), self.expect_error(armwright.UsageError, *pieces):
                call()

    def test_plugins_of_a_recorded_study_need_trust(self):
        pathlib.Path("theirs/cells").mkdir(parents=True)
        pathlib.Path("theirs/study.toml").write_text('problems = ["sphere"]\nreplicates = 2\nbudget = 30\n'
                                                     'optimizers = ["ga", "exec:sh -c \'echo > PWNED\'"]\n')
        with self.expect_error(armwright.BadDataError, "it has no plan_sha256"):
            armwright.load_study("theirs")
        with self.expect_error(armwright.UsageError, "would run, with all of your rights: exec:sh -c 'echo > PWNED'", "trust=True"):
            armwright.compare(study="theirs/study.toml")
        self.assertFalse(pathlib.Path("PWNED").exists())
        with self.expect_error(armwright.BadDataError, "before it described itself"):
            armwright.compare(study="theirs/study.toml", trust=True)
        self.assertTrue(pathlib.Path("PWNED").exists())

    def test_interrupted_and_gone_on_with(self):
        whole = compare(problems=["sphere"], optimizers=[Steps, "ga"], out="whole", budget=400)
        text = ("import armwright, time\nfrom support import Steps\nprint('begun', flush=True)\n"
                "def show(state): time.sleep(0.1)\n"
                "try: armwright.compare(['sphere'], [Steps, 'ga'], replicates=6, budget=400, set={'function.dimension': 3}, out='broken',\n"
                "                       progress=show, jobs=1)\n"
                "except KeyboardInterrupt as stop: print(stop)\n")
        child = subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, text=True)
        child.stdout.readline()
        while not pathlib.Path("broken/cells/sphere/python%3Asteps/r01").exists() and child.poll() is None:
            time.sleep(0.005)
        child.send_signal(signal.SIGINT)
        self.assertIn("the same call of armwright.compare() goes on", child.communicate(timeout=60)[0])
        self.assertFalse(armwright.load_study("broken").finished)
        again = compare(problems=["sphere"], optimizers=[Steps, "ga"], out="broken", budget=400)
        self.assertEqual(again.to_dict(), whole.to_dict())


if __name__ == "__main__":
    unittest.main()
