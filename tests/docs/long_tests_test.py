"""Run by ctest: each row of tests/long-tests.md names tests that are there, and a quick guard that is no long test. Long tests of ctest have the
label long, by which the quick check leaves them out.

    long_tests_test.py CTEST BUILD_FOLDER
"""

import fnmatch
import pathlib
import re
import sys

import reliability_test

TABLE = pathlib.Path(__file__).resolve().parents[1] / "long-tests.md"


def find_faults(text, names, quick=frozenset()):
    """`quick` are the tests of ctest without the label long."""
    rows = [line.strip("|").split(" | ") for line in text.splitlines() if line.startswith("| `")]
    faults = []
    long = set()
    guards = []
    for row in rows:
        if len(row) != 3:
            faults.append(f"not three columns: {row}")
            continue
        test = row[0].strip(" `")
        matched = set(fnmatch.filter(names, test))
        if not matched:
            faults.append(f"{test}: there is no such test")
        named = re.findall(r"`([^`]+)`", row[2])
        if not named:
            faults.append(f"{test}: no test guards the same in the quick check")
        if named != [test]:
            long |= matched
            faults += [f"{one}: it has not the label long, so the quick check runs it" for one in sorted(matched & quick)]
            guards += named
    for guard in guards:
        matched = set(fnmatch.filter(names, guard))
        if not matched:
            faults.append(f"{guard}: there is no such guard")
        elif matched <= long:
            faults.append(f"{guard}: this guard is a long test itself")
    return faults


def test_this_test():
    names = {"a.Long/S.T/0", "a.S.T", "a.S.U"}
    assert not find_faults("| `a.Long/S.*` | many | `a.S.T` |\n| `a.S.U` | many | `a.S.U` |", names)
    assert find_faults("| `a.Long/S.T/0` | many | `a.S.T` |", names, {"a.Long/S.T/0"}) == ["a.Long/S.T/0: it has not the label long, so the quick check runs it"]
    for row, fault in [("| `a.S.V` | many | `a.S.T` |", "a.S.V: there is no such test"), ("| `a.S.T` | many | none |", "no test guards"),
                       ("| `a.S.T` | many | `a.S.V` |", "there is no such guard"), ("| `a.S.*` | many | `a.S.T` |", "a long test itself")]:
        assert fault in "\n".join(find_faults(row, names)), row


if __name__ == "__main__":
    test_this_test()
    quick = reliability_test.list_of_ctest(*sys.argv[1:3]) - reliability_test.list_of_ctest(*sys.argv[1:3], "-L", "^long$")
    problems = find_faults(TABLE.read_text(), reliability_test.list_tests(*sys.argv[1:3]), quick)
    print("\n".join(problems) or "long tests: all are there, and so are their guards")
    sys.exit(1 if problems else 0)
