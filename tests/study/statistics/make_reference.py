"""Reference values for the statistics, by other hands: scipy and numpy, R, and definitions worked out by
brute force.

  make_reference.py write FILE         makes the inputs and computes the references; needs scipy and R
  make_reference.py check scipy FILE   computes them anew from the inputs in FILE and compares; likewise with r

A check without scipy or R ends with status 77, which ctest knows as skipped. Infinity is "inf" in FILE."""

import json
import math
import shutil
import subprocess
import sys
from pathlib import Path

SKIPPED = 77
TOLERANCE = 1e-10  # relative; both compute in double precision, tails of distributions to about 1e-12


def encode(numbers):
    return ["inf" if number == math.inf else float(number) for number in numbers]


def decode(numbers):
    return [float(number) for number in numbers]


def compute_with_scipy(cases):
    import reference_definitions
    import reference_scipy

    results = []
    for case in cases:
        module = reference_scipy if hasattr(reference_scipy, case["function"]) else reference_definitions
        results.append(getattr(module, case["function"])(*case["arguments"]))
    return results


def compute_with_r(cases):
    """One R process for all."""
    lines = []
    for case in cases:
        arguments = [" ".join("Inf" if x == math.inf else repr(x) for x in xs) for xs in case["arguments"]]
        lines.append("|".join([case["function"], *arguments]) + "\n")
    script = Path(__file__).with_name("reference.R")
    run = subprocess.run(["Rscript", "--vanilla", script], input="".join(lines), capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(f"R failed: {run.stderr}")
    results = [decode(line.split()) for line in run.stdout.splitlines()]
    assert len(results) == len(cases)
    return results


def suits_r(case):
    """What R offers, and on which data without an approximation or a NaN."""
    function, arguments = case["function"], case["arguments"]
    finite = all(x < math.inf for xs in arguments for x in xs)
    if function in ("ranks", "quantile", "spread", "holm", "runtime_ecdf"):
        return function != "runtime_ecdf" or finite or any(x < math.inf for x in arguments[1])
    if function == "signed_rank":
        differences = [abs(a - b) for a, b in zip(*arguments) if a != b]
        plain = len(set(differences)) == len(differences) == len(arguments[0])
        return finite and (plain or 0 < len(differences) <= 14 or len(differences) == len(arguments[0]) > 50)
    if function == "friedman":
        return any(len(set(block)) > 1 for block in arguments)
    if function == "kendall":
        return all(len(set(xs)) > 1 for xs in arguments)
    if function == "resampled_interval":
        return True
    return function == "a12" and finite


def close(a, b):
    if len(a) != len(b):
        return False
    return all(x == y or abs(x - y) <= TOLERANCE * max(abs(x), abs(y)) for x, y in zip(a, b))


def write(path):
    from reference_cases import make_cases

    cases = [{"function": f, "name": name, "arguments": arguments} for f, name, arguments in make_cases()]
    for case, result in zip(cases, compute_with_scipy(cases)):
        case["scipy"] = result
    for_r = [case for case in cases if suits_r(case)]
    for case, result in zip(for_r, compute_with_r(for_r)):
        case["r"] = result
        if not close(result, case["scipy"]):
            sys.exit(f"scipy and R differ: {case}")
    for case in cases:
        case["arguments"] = [encode(xs) for xs in case["arguments"]]
        case.update({source: encode(case[source]) for source in ("scipy", "r") if source in case})
    text = ",\n".join(json.dumps(case, allow_nan=False) for case in cases)
    Path(path).write_text(f'{{"cases": [\n{text}\n]}}\n')
    print(f"{len(cases)} cases, {len(for_r)} of them by R, too")


def check(source, path):
    if source == "r" and not shutil.which("Rscript"):
        print("skipped: R is not installed (Debian package r-base-core)")
        sys.exit(SKIPPED)
    if source == "scipy":
        try:
            import scipy
        except ImportError:
            print(f"skipped: {sys.executable} has no scipy (Debian package python3-scipy)")
            sys.exit(SKIPPED)
    cases = [case for case in json.loads(Path(path).read_text())["cases"] if source in case]
    for case in cases:
        case["arguments"] = [decode(xs) for xs in case["arguments"]]
    results = (compute_with_scipy if source == "scipy" else compute_with_r)(cases)
    wrong = [(c, r) for c, r in zip(cases, results) if not close(r, decode(c[source]))]
    for case, result in wrong:
        print(f"{case['function']}, {case['name']}: stored {case[source]}, {source} computes {result}")
    print(f"{len(cases) - len(wrong)} of {len(cases)} stored values are what {source} computes")
    sys.exit(1 if wrong or not cases else 0)


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    if len(sys.argv) == 3 and sys.argv[1] == "write":
        write(sys.argv[2])
    elif len(sys.argv) == 4 and sys.argv[1] == "check" and sys.argv[2] in ("scipy", "r"):
        check(sys.argv[2], sys.argv[3])
    else:
        sys.exit(__doc__)
