"""docs/reliability.md and the tests agree: each test that the table names is there, and each test of faults is in the table."""

import pathlib
import re
import subprocess
import sys

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "reliability.md"
ROOMS = "base|cli|contract|e2e|faults|optimizers|page|problems|report|sim|study|fuzz|doctor|memory"


def plain(name):
    """Room.Instantiation/Suite.Test/parameter without what values and types it is tried with."""
    return re.sub(r"^(\w+)\.(?:\w+/)?([\w]+)(?:/\w+)?\.(\w+)(?:/\w+)?$", r"\1.\2.\3", name)


def list_of_ctest(ctest, build, *options):
    """The names of the tests of ctest."""
    text = subprocess.run([ctest, "-N", *options], cwd=build, check=True, capture_output=True, text=True).stdout
    return {line.split(": ", 1)[1].strip() for line in text.splitlines() if re.match(r"\s*Test\s+#\d+: ", line)}


def list_tests(ctest, build):
    """The names of the tests of ctest, with those in the test programs, as PROGRAM.SUITE.TEST, in place of the programs."""
    names = list_of_ctest(ctest, build)
    for program in sorted((pathlib.Path(build) / "bin").glob("*_tests")):
        room = program.name.removesuffix("_tests")
        names = {name for name in names if not re.fullmatch(rf"{room}(\.\d+|\.long)?", name)}
        text = subprocess.run([program, "--gtest_list_tests"], check=True, capture_output=True, text=True).stdout
        suite = ""
        for line in text.splitlines():
            name = line.split("#")[0].rstrip()
            if not line.startswith(" "):
                suite = name
            else:
                names.add(f"{room}.{suite}{name.strip()}")
    return names


def list_named(text):
    """What the last column of each row names, as code."""
    rows = [line for line in text.splitlines() if line.startswith("|")]
    return {name for row in rows for name in re.findall(r"`((?:%s)\.[\w.]+)`" % ROOMS, row)}


def main(ctest, build):
    tests = {plain(name) for name in list_tests(ctest, build)}
    named = list_named(PAGE.read_text())
    faults = {test for test in tests if test.startswith("faults.")}
    problems = [f"{name}: the page names it, and there is no such test" for name in sorted(named - tests)]
    problems += [f"{name}: a test of faults that the page does not name" for name in sorted(faults - named)]
    if not faults:
        problems.append("no tests of faults are built here: build all targets first")
    print("\n".join(problems) or f"reliability: {len(named)} tests named, all there")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
