"""Run by ctest: scripts/compile-alone finds files that lack an include, in a small tree whose build joins its files."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/compile-alone"
WITHOUT_INCLUDE = "std::string name() { return {}; }\n"
WITH_INCLUDE = "#include <string>\n" + WITHOUT_INCLUDE


class CompileAlone(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve()
        self.write("src/a/first.cpp", '#include <string>\n#include "a/first.hpp"\n')
        self.write("src/a/first.hpp", "#pragma once\n#include <string>\ninline std::string first() { return {}; }\n")
        self.write("src/a/second.cpp", WITHOUT_INCLUDE)
        batch = self.root / "build/ci/src/CMakeFiles/a.dir/Unity/unity_0_cxx.cxx"
        self.write(batch, "".join(f'#include "{self.root}/src/a/{name}.cpp"\n' for name in ("first", "second")))
        command = f"{os.environ.get('CXX', 'c++')} -I{self.root}/src -Wall -Werror -o unity_0_cxx.cxx.o -c {batch}"
        self.write("build/ci/compile_commands.json", json.dumps([{"directory": str(self.root), "command": command, "file": str(batch)}]))
        self.write(".gitignore", "/build/\n")
        self.git("init", "--quiet")
        self.commit()

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def git(self, *words):
        who = ["-c", "user.name=A", "-c", "user.email=a@example.org"]
        subprocess.run(["git", "-C", self.root, *who, *words], capture_output=True, check=True)

    def commit(self):
        self.git("add", "--all")
        self.git("commit", "--quiet", "--message", "Some files change")

    def run_script(self, *words):
        done = subprocess.run([sys.executable, SCRIPT, "--root", self.root, *words], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout + done.stderr

    def test_names_a_joined_file_that_lacks_an_include(self):
        code, output = self.run_script("--all")
        self.assertEqual(code, 1, output)
        self.assertIn("src/a/second.cpp: does not compile alone", output)
        self.assertIn("1 of 3 files do not compile alone", output)

    def test_compiles_a_header_alone(self):
        self.write("src/a/second.hpp", "#pragma once\ninline std::string second() { return {}; }\n")
        code, output = self.run_script("src/a/first.hpp", "src/a/second.hpp")
        self.assertEqual(code, 1, output)
        self.assertIn("src/a/second.hpp: does not compile alone", output)
        self.assertIn("1 of 2 files", output)

    def test_takes_what_the_last_commit_and_the_working_tree_change(self):
        self.write("src/a/first.hpp", "#pragma once\n")
        self.commit()
        code, output = self.run_script()
        self.assertEqual(code, 0, output)
        self.assertIn("1 files compile alone", output)
        self.write("src/a/second.cpp", WITH_INCLUDE)
        self.write("src/a/new.hpp", "#pragma once\n")
        code, output = self.run_script()
        self.assertEqual(code, 0, output)
        self.assertIn("3 files compile alone", output)

    def test_takes_everything_if_there_is_one_commit_only(self):
        code, output = self.run_script()
        self.assertEqual(code, 1, output)
        self.assertIn("this clone has no commit before HEAD", output)
        self.assertIn("1 of 3 files", output)

    def test_says_how_many_files_it_leaves_out(self):
        code, output = self.run_script("--most", "2")
        self.assertEqual(code, 0, output)
        self.assertIn("1 more changed files are left to scripts/test --strict", output)

    def test_asks_for_a_build(self):
        code, output = self.run_script("--build", "missing")
        self.assertEqual(code, 2, output)
        self.assertIn("is not configured; run cmake --preset ci", output)


unittest.main()
