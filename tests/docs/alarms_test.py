"""scripts/alarms: its statistics, its limits, the tables that it writes, and a few studies of the program in $ARMWRIGHT."""

import contextlib
import csv
import importlib.machinery
import importlib.util
import io
import os
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/alarms"
loader = importlib.machinery.SourceFileLoader("alarms", str(SCRIPT))
alarms = importlib.util.module_from_spec(importlib.util.spec_from_loader("alarms", loader))
sys.modules["alarms"] = alarms  # dataclasses look there
loader.exec_module(alarms)

PROGRAM = os.environ.get("ARMWRIGHT", SCRIPT.parents[1] / "build/release/bin/armwright")
TINY = dict(function="sphere", replicates=6, seed=1)


class AlarmsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.table = pathlib.Path(folder.name) / "studies.csv"

    def measure(self, program, studies):
        with contextlib.redirect_stderr(io.StringIO()):
            alarms.measure(program, studies, self.table, 2)
        with self.table.open(newline="") as stream:
            return list(csv.DictReader(stream))

    def test_critical_sums_are_those_of_wilcoxons_table(self):
        for pairs, critical in ((5, -1), (6, 0), (7, 2), (10, 8), (15, 25), (25, 89)):
            self.assertEqual(alarms.find_critical_sum(pairs)[0], critical, pairs)
        self.assertAlmostEqual(alarms.find_critical_sum(15)[1], 1570 / 2**15)

    def test_interval_is_wilsons(self):
        for share, value in zip(alarms.calc_interval(0, 10) + alarms.calc_interval(15, 148), (0, 0.2775, 0.0624, 0.1605)):
            self.assertAlmostEqual(share, value, places=4)

    def test_power_grows_with_the_effect_and_begins_at_half_the_level(self):
        powers = [alarms.predict_power(15, a12) for a12 in (0.5, 0.64, 0.79)]
        self.assertAlmostEqual(powers[0], alarms.find_critical_sum(15)[1] / 2, delta=0.01)
        self.assertEqual(powers, sorted(powers))
        self.assertEqual(alarms.predict_power(5, 0.99), 0)

    def test_rates_and_powers_outside_the_limits_fail(self):
        good, power = {"optimizer": "ga", "rate": 0.05}, {"optimizers": "a > b", "function": "f", "replicates": 9, "model_holds": 1, "predicted": 0.5}
        alarms.check_limits([good], [power | {"power": 0.59}, power | {"power": 0.9, "model_holds": 0}])
        for rates, powers in (([good | {"rate": 0.015}], []), ([good | {"rate": 0.095}], []), ([good], [power | {"power": 0.39}])):
            with self.assertRaises(alarms.Failure):
                alarms.check_limits(rates, powers)

    def test_a_page_gets_the_rows_of_its_tables(self):
        page = "Text.\n\n| a | b |\n|---|---|\n| old | row |\n\nMore.\n"
        filled = alarms.fill_page(page, [("| a | b |", ["| 1 | 2 |", "| 3 | 4 |"])])
        self.assertEqual(filled, "Text.\n\n| a | b |\n|---|---|\n| 1 | 2 |\n| 3 | 4 |\n\nMore.\n")
        with self.assertRaises(alarms.Failure):
            alarms.fill_page(page, [("| c |", [])])

    def test_studies_have_their_own_instances_and_keys(self):
        studies = alarms.make_studies(3)
        self.assertEqual(len({study.make_key() for study in studies}), len(studies))
        a_a = [study for study in studies if study.kind == "A/A" and study.a.name == "ga"]
        self.assertEqual([study.first_instance for study in a_a], [1, 16, 31])

    def test_runs_studies_once_and_continues_after_a_cut(self):
        ga, cmaes = alarms.Method("ga"), alarms.Method("cmaes")
        studies = [alarms.Study("A/A", ga, ga, **TINY), alarms.Study("A/B", cmaes, ga, **TINY), alarms.Study("A/B", ga, cmaes, **TINY)]
        rows = self.measure(PROGRAM, studies)
        self.assertEqual([row["key"] for row in rows], [study.make_key() for study in studies])
        self.assertEqual(rows[0]["a"], rows[0]["b"])
        self.assertLess(int(rows[0]["ties"]), 6)  # the two are independent runs
        self.assertEqual([row["found"] for row in rows[1:]], ["a", "b"])  # whichever stands first
        self.assertEqual(rows[1]["a12"], "1")
        self.assertEqual(rows[2]["a12"], "0")
        whole = self.table.read_text()
        self.assertEqual(self.measure("/nonexistent", studies), rows)  # nothing is run again
        self.table.write_text(whole[:-30])  # the last row was cut off
        with self.assertRaises(FileNotFoundError):
            self.measure("/nonexistent", studies)
        self.measure(PROGRAM, studies)
        self.assertEqual(self.table.read_text(), whole)

    def test_predictions_are_those_of_the_dry_run(self):
        alarms.check_prediction(PROGRAM, 15)


if __name__ == "__main__":
    unittest.main()
