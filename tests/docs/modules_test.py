"""Run by ctest: scripts/modules finds what it shall find in small source trees, and passes a tree that keeps its declaration."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/modules"
MODULES = """
[module."low"]
label = "low"
purpose = "Below."
uses = []

[module."high"]
label = "high"
purpose = "Above."
uses = ["low"]
"""


class Modules(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        self.write("modules.toml", MODULES)
        self.write("low/a.hpp", "struct A {};\n")
        self.write("high/b.cpp", '#include "low/a.hpp"\n')

    def write(self, name, text):
        path = self.root / "src" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def run_script(self, *words):
        done = subprocess.run([sys.executable, SCRIPT, *words, "--root", self.root], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout + done.stderr

    def expect_fault(self, text):
        code, output = self.run_script("--check")
        self.assertEqual(code, 1, output)
        self.assertIn(text, output)

    def test_passes_a_tree_that_keeps_its_declaration(self):
        code, output = self.run_script("--check")
        self.assertEqual(code, 0, output)

    def test_names_file_and_line_of_an_undeclared_include(self):
        self.write("low/c.cpp", '// why\n#include "high/b.hpp"\n')
        self.write("high/b.hpp", "")
        self.expect_fault("src/low/c.cpp:2: includes \"high/b.hpp\", but 'low' may not use 'high'")

    def test_finds_a_cycle_of_includes(self):
        self.write("low/c.cpp", '#include "high/b.hpp"\n')
        self.write("high/b.hpp", "")
        self.expect_fault("the includes form a cycle")

    def test_finds_a_declared_cycle(self):
        self.write("modules.toml", MODULES.replace("uses = []", 'uses = ["high"]'))
        self.expect_fault("the declared modules form a cycle")

    def test_finds_a_folder_that_is_not_declared(self):
        self.write("other/a.cpp", "")
        self.expect_fault("src/other: this folder is not declared")

    def test_finds_a_declared_edge_that_no_file_uses(self):
        self.write("high/b.cpp", "")
        self.expect_fault("'high' may use 'low' but includes nothing of it")

    def test_finds_a_folder_past_its_limit(self):
        for number in range(41):
            self.write(f"low/file_{number}.cpp", "")
        self.expect_fault("src/low: has 42 files; at most 40 are allowed")

    def test_counts_types_with_a_body_in_headers(self):
        self.write("low/t.hpp", "class B;\n// class C {\nclass D final : public A {\n  struct E {};\n};\nenum class F { g };\n")
        code, output = self.run_script("--count")
        self.assertEqual(code, 0, output)
        types = [line.split()[4] for line in output.splitlines() if line.startswith("low")]
        self.assertEqual(types, ["4"])

    def test_lists_every_file_with_its_first_sentence(self):
        self.write("low/a.hpp", "// Adds a | b. Throws nothing.\n#pragma once\n")
        self.write("low/a.cpp", "int a;\n")
        self.write("high/b.cpp", "// Uses a\n// twice. More.\n\n// Other.\n")
        code, output = self.run_script("--index")
        self.assertEqual(code, 0, output)
        page = (pathlib.Path(self.root) / "src/README.md").read_text(encoding="utf-8")
        self.assertIn("| [a.hpp](low/a.hpp) | Adds a \\| b. |", page)
        self.assertIn("| [b.cpp](high/b.cpp) | Uses a twice. |", page)
        self.assertNotIn("a.cpp", page)
        self.assertEqual(self.run_script("--index", "--check")[0], 0)
        self.write("low/a.hpp", "// Subtracts.\n")
        code, output = self.run_script("--index", "--check")
        self.assertEqual(code, 1, output)
        self.assertIn("src/README.md is out of date: run scripts/modules --index", output)

    def test_the_index_refuses_a_file_without_a_comment(self):
        self.write("low/a.hpp", "// Adds.\n")
        self.write("high/b.cpp", "int b;\n")
        code, output = self.run_script("--index")
        self.assertEqual(code, 1, output)
        self.assertIn("src/high/b.cpp:1: begins with no comment", output)


unittest.main()
