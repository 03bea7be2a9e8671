"""The package is typed throughout, and what it says of the module inside is what that module has."""
import ast
import inspect
import os
import subprocess
import unittest

from support import FolderTest, ROOT

import armwright
from armwright import _armwright

PACKAGE = ROOT / "python/armwright"


class TypesTest(FolderTest):
    def test_mypy_finds_nothing(self):
        examples = sorted((ROOT / "python/examples").glob("*.py"))
        words = ["--config-file", str(ROOT / "python/mypy.ini"), "--no-error-summary", "--cache-dir", str(self.folder / "cache")]
        done = subprocess.run(["/usr/bin/mypy", *words, str(PACKAGE), *map(str, examples)], capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": ""})
        self.assertEqual((done.stdout, done.returncode), ("", 0), done.stderr)

    def test_stubs_name_what_is_there(self):
        stub = ast.parse((PACKAGE / "_armwright.pyi").read_text())

        def list_names(body):
            names = {one.name: one for one in body if isinstance(one, (ast.FunctionDef, ast.ClassDef))}
            return {name: one for name, one in names.items() if not name.startswith("_")}

        def check(body, real, where):
            public = {name for name in vars(real) if not name.startswith("_") and name != "STATUSES"}
            self.assertEqual(set(list_names(body)), public, where)
            for name, one in list_names(body).items():
                if isinstance(one, ast.ClassDef):
                    check(one.body, getattr(real, name), name)
                elif inspect.isroutine(getattr(real, name)):
                    parameters = [argument.arg for argument in (*one.args.posonlyargs, *one.args.args)]
                    told = getattr(real, name).__doc__.split("\n")[0]  # name(arg0: int, ...) -> ...
                    self.assertEqual(len(parameters), told.count("arg") + told.count("self:"), told)

        check(stub.body, _armwright, "the module")

    def test_everything_public_has_a_docstring(self):
        for name in armwright.__all__:
            one = getattr(armwright, name)
            if inspect.isclass(one) or inspect.isfunction(one):
                self.assertTrue(inspect.getdoc(one), name)
            if inspect.isclass(one) and not issubclass(one, Exception):
                for member, value in vars(one).items():
                    if inspect.isfunction(value) and not member.startswith("_"):
                        self.assertTrue(inspect.getdoc(value), f"{name}.{member}")


if __name__ == "__main__":
    unittest.main()
