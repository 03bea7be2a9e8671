"""scripts/findings: what it puts in, and what it refuses."""

import importlib.machinery
import importlib.util
import pathlib
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "findings"
LOADER = importlib.machinery.SourceFileLoader("findings", str(SCRIPT))
findings = importlib.util.module_from_spec(importlib.util.spec_from_loader("findings", LOADER))
LOADER.exec_module(findings)


class FindingsTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        part = pathlib.Path(self.folder.name) / "q9"
        part.mkdir()
        (part / "summary.csv").write_text("optimizer,median\nga,0.00125\nfast,0.000099996\n")
        (part / "verdict.txt").write_text("fast beats ga.\nThat is all.\n")
        self.tables = findings.Tables(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def make(self, template):
        return findings.make_page(template, self.tables)

    def refuse(self, template, message):
        with self.assertRaises(findings.Failure) as caught:
            self.make(template)
        self.assertIn(message, str(caught.exception))

    def test_numbers_come_from_the_tables(self):
        self.assertEqual(self.make("{{ mm(get('q9/summary.csv', 'median', optimizer='ga')) }} mm"), "1.25 mm")
        self.assertEqual(self.make("{{ verdict('q9')[0] }}"), "fast beats ga.")

    def test_tables_are_made_of_rows(self):
        template = "{% rows %}\nfor row in rows('q9/summary.csv'):\n    emit(row['optimizer'], mm(row['median']))\n{% end %}\n"
        self.assertEqual(self.make(template), "| ga | 1.25 |\n| fast | 0.100 |\n")

    def test_what_a_block_defines_is_there_further_down(self):
        template = "{% rows %}\ndef median(name):\n    return get('q9/summary.csv', 'median', optimizer=name)\n{% end %}\n{{ mm(median('ga')) }}"
        self.assertEqual(self.make(template), "1.25")

    def test_numbers_are_rounded_to_digits_that_count(self):
        for value, count, text in ((28927, 3, "28 900"), (99.96, 3, "100"), (0.0456, 2, "0.046"), (9876, 4, "9876"), (0, 3, "0"), ("inf", 3, "∞")):
            self.assertEqual(findings.digits(value, count), text)

    def test_a_number_that_nobody_computed_is_refused(self):
        self.refuse("All is well:\nit is 5 mm.\n", "findings.template.md:2: '5' comes from no table")

    def test_names_are_no_numbers(self):
        text = "## 1. Q1 to E6\nTable 6.4 and Fig. 6.12 of the thesis (2010), design A.10, `--cases 100`, [page](verify2.md).\n"
        self.assertEqual(self.make(text), text)

    def test_what_the_text_says_must_be_so(self):
        condition = "get('q9/summary.csv', 'median', optimizer='fast') < get('q9/summary.csv', 'median', optimizer='ga')"
        self.assertEqual(self.make("{% require " + condition + ": fast is better %}\nGood.\n"), "Good.\n")
        self.refuse("\n{% require not (" + condition + "): ga is better %}\n", "template.md:2: the tables do not say that ga is better")

    def test_missing_tables_rows_and_columns_are_named(self):
        self.refuse("{{ get('q8/summary.csv', 'median') }}", "summary.csv is missing; scripts/reference-study makes it")
        self.refuse("{{ get('q9/summary.csv', 'median', optimizer='none') }}", "has 0 rows with {'optimizer': 'none'}")
        self.refuse("{{ get('q9/summary.csv', 'mean', optimizer='ga') }}", "has no column mean; it has optimizer, median")
        self.refuse("{{ 1 / 0 }}", "template.md:1: ZeroDivisionError")


if __name__ == "__main__":
    unittest.main()
