"""All code and all commands of docs/python.md, run from top to bottom in an empty folder."""
import os
import pathlib
import re
import subprocess
import sys
import unittest

from support import FolderTest, PROGRAM, ROOT

import armwright

PAGE = (ROOT / "docs/python.md").read_text()


class DocsTest(FolderTest):
    def test_code_and_commands_run(self):
        blocks = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE, re.M | re.S)
        self.assertEqual({kind for kind, _ in blocks}, {"python", "sh"})
        # What is shown of a build tree is there, as it is here.
        pathlib.Path("build").symlink_to(pathlib.Path(PROGRAM).parents[2])
        source, commands = "", []
        for kind, text in blocks:
            if kind == "python":
                source += text + "\n"
            else:
                commands.append(text)
        pathlib.Path("page.py").write_text(source)
        environment = {**os.environ, "PATH": f"{pathlib.Path(PROGRAM).parent}:{os.environ['PATH']}"}
        done = subprocess.run([sys.executable, "page.py"], capture_output=True, text=True, env=environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("python:Halving", done.stdout)
        for command in commands:
            if "python_benchmark" not in command:  # minutes; the page says what came out
                done = subprocess.run(["bash", "-ec", command], capture_output=True, text=True, env=environment)
                self.assertEqual(done.returncode, 0, f"{command}\n{done.stderr}")

    def test_calls_that_are_named_exist(self):
        for name in re.findall(r"`(?:problem\.)?(\w+)\(", PAGE.split("| call |")[1].split("**Numbers.**")[0]):
            self.assertTrue(any(hasattr(one, name) for one in (armwright, armwright.Problem, armwright.Study, armwright.Run)), name)


if __name__ == "__main__":
    unittest.main()
