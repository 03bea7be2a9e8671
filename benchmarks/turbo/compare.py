#!/usr/bin/env python3
"""Compares turbo with a plain Gaussian process and expected improvement (expected_improvement.py).

    benchmarks/turbo/compare.py record FILE.csv [--problems A,B] [--replicates 5]
    benchmarks/turbo/compare.py table FILE.csv

`record` runs the other program and adds its results to FILE.csv: for every problem and replicate the best value
minus the known minimum after 25, 50, 100, 150 and 200 evaluations. Replicate r has the instance r of the function,
and begins with the start and the Latin hypercube of turbo with seed r. It needs scikit-learn (Debian:
python3-sklearn), and takes about a minute per replicate in ten variables. Results that FILE.csv has are not made
again.

`table` runs turbo on the same problems and replicates, and prints a table as Markdown. The p-value is that of the
exact sign test of the pairs after 200 evaluations, two-sided; differences below 1e-8 are ties and are left out.

$ARMWRIGHT names another program than build/release/bin/armwright.
"""
import argparse
import csv
import json
import math
import os
import pathlib
import platform
import shutil
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = os.environ.get("ARMWRIGHT", str(HERE.parent.parent / "build/release/bin/armwright"))
PROBLEMS = {"branin": 2, "hartmann6": 6, "ackley": 10, "sphere": 10, "ellipsoid": 10, "rosenbrock": 10, "rastrigin": 10,
            "bbob-f1": 10, "bbob-f2": 10, "bbob-f3": 10, "bbob-f8": 10, "bbob-f10": 10, "bbob-f15": 10}
MINIMA = {"branin": 0.39788735772973816, "hartmann6": -3.322368011415515}  # of the others: 0
FIXED = {"branin", "hartmann6"}  # have no instances
BUDGET = 200
MARKS = (25, 50, 100, 150, 200)
TIE = 1e-8  # the resolution of the functions


def run(problem, replicate, optimizer, options, budget, folder):
    """Runs one optimizer and returns its evaluations in their order: points and values."""
    command = [PROGRAM, "optimize", problem, "--optimizer", optimizer, "--seed", str(replicate), "--budget", str(budget),
               "--jobs", "1", "--quiet", "--out", str(folder / "run")]
    for option in options:
        command += ["--opt", option]
    if problem not in FIXED:
        command += ["--set", f"function.instance={replicate}"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    subprocess.run([PROGRAM, "export", str(folder / "run"), "--format", "csv", "--out", str(folder / "csv")], check=True,
                   stdout=subprocess.DEVNULL)
    (table,) = (folder / "csv" / "evaluations").glob("*.csv")
    with open(table, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    shutil.rmtree(folder / "run")
    shutil.rmtree(folder / "csv")
    variables = [f"x.x_{i + 1}" for i in range(PROBLEMS[problem])]
    return [[float(row[name]) for name in variables] for row in rows], [float(row["objective"]) for row in rows]


def find_gaps(problem, values):
    return [min(values[:mark]) - MINIMA.get(problem, 0.0) for mark in MARKS]


def read_gaps(path):
    if not path.exists():
        return {}
    with open(path, newline="", encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {(row["problem"], int(row["replicate"])): [float(row[f"gap_{mark}"]) for mark in MARKS] for row in rows}


def record(path, problems, replicates):
    known = read_gaps(path)
    if not known:
        versions = subprocess.run(["/usr/bin/python3", "-c", "import sklearn, scipy, numpy; print(f'scikit-learn {sklearn.__version__}, "
                                   "SciPy {scipy.__version__}, NumPy {numpy.__version__}')"], check=True, capture_output=True,
                                  text=True).stdout.strip()
        with open(path, "w", encoding="utf-8") as file:
            file.write(f"# Made by benchmarks/turbo/compare.py record. {versions}, Python {platform.python_version()}\n")
            file.write("problem,replicate," + ",".join(f"gap_{mark}" for mark in MARKS) + "\n")
    for replicate in range(1, replicates + 1):
        for problem in problems:
            if (problem, replicate) in known:
                continue
            with tempfile.TemporaryDirectory() as name:
                folder = pathlib.Path(name)
                first = max(2 * PROBLEMS[problem], 5)
                points, _ = run(problem, replicate, "turbo", [f"initial={first}"], first, folder)
                design = folder / "design.json"
                design.write_text(json.dumps(points), encoding="utf-8")
                _, values = run(problem, replicate, f"exec:/usr/bin/python3 {HERE / 'expected_improvement.py'}", [f"design={design}", "silence_s=3600"],
                                BUDGET, folder)
            with open(path, "a", encoding="utf-8") as file:
                file.write(f"{problem},{replicate}," + ",".join(repr(gap) for gap in find_gaps(problem, values)) + "\n")


def calc_sign_test(better, worse):
    """Returns the two-sided exact p-value."""
    n = better + worse
    tail = sum(math.comb(n, k) for k in range(min(better, worse) + 1)) / 2**n
    return min(1.0, 2 * tail) if n > 0 else 1.0


def make_table(path):
    others = read_gaps(path)
    lines = ["| problem | replicates | turbo, 100 | other, 100 | turbo, 200 | other, 200 | better / worse | p |", "|---|---|---|---|---|---|---|---|"]
    for problem in PROBLEMS:
        replicates = sorted(r for name, r in others if name == problem)
        if not replicates:
            continue
        own = []
        for replicate in replicates:
            with tempfile.TemporaryDirectory() as name:
                own.append(find_gaps(problem, run(problem, replicate, "turbo", [], BUDGET, pathlib.Path(name))[1]))
        other = [others[problem, r] for r in replicates]
        differences = [a[-1] - b[-1] for a, b in zip(own, other) if abs(a[-1] - b[-1]) >= TIE]
        better, worse = sum(d < 0 for d in differences), sum(d > 0 for d in differences)
        medians = [statistics.median(gaps[MARKS.index(mark)] for gaps in side) for mark in (100, 200) for side in (own, other)]
        lines.append(f"| `{problem}` | {len(replicates)} | " + " | ".join(f"{m:.2g}" for m in medians) +
                     f" | {better} / {worse} | {calc_sign_test(better, worse):.2g} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=["record", "table"])
    parser.add_argument("file", type=pathlib.Path)
    parser.add_argument("--problems", default=",".join(PROBLEMS))
    parser.add_argument("--replicates", type=int, default=5)
    options = parser.parse_args()
    if options.action == "table":
        print(make_table(options.file))
        return
    unknown = [name for name in options.problems.split(",") if name not in PROBLEMS]
    if unknown:
        sys.exit(f"compare.py: unknown problem '{unknown[0]}'; these are possible: {', '.join(PROBLEMS)}")
    record(options.file, options.problems.split(","), options.replicates)


if __name__ == "__main__":
    main()
