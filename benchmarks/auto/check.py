#!/usr/bin/env python3
"""Checks the optimizer `auto` on problems that its rules were not made with.

    benchmarks/auto/check.py run FOLDER [--check second] [--budgets 200,1000,5000] [--replicates 10] [--jobs 2]
    benchmarks/auto/check.py table FOLDER [--check second]

The rules have been changed after the first check. The second check has problems that they were not made with.

`run` builds the users' problems with g++ and runs one study per problem and budget: auto beside a pool of optimizers.
Cells that are complete are not run again. `table` prints Markdown. A cell is *good* if two things hold:

- auto is not significantly worse than the best of the pool, the optimizer with the smallest median. The test is the
  exact Wilcoxon test of the study (tables/pairs.csv), with Holm's correction over the comparisons of auto with the pool.
- The gap of auto's median to the best known value is at most 1.5 times that of the best of the pool. The best known
  value is the minimum of the function, or the best value of all runs here. Gaps below the resolution count as equal.

$ARMWRIGHT names another program than build/release/bin/armwright.
"""
import argparse
import csv
import json
import math
import os
import pathlib
import statistics
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
PROGRAM = os.environ.get("ARMWRIGHT", str(ROOT / "build/release/bin/armwright"))
SURROGATE = {"name": "cmaes", "label": "cmaes surrogate", "options": ["surrogate=quadratic"]}
POOL = ["cmaes", "ga", "nlopt:cobyla", "nlopt:bobyqa", "nlopt:sbplx", "pagmo:sade", "random"]
MOST_TURBO = 200  # evaluations

# The users' problems are libraries that are built from these sources.
USERS = {"speed-control": ROOT / "examples/own_program/speed_control_library.cpp", "kinetics": HERE / "kinetics.cpp",
         "cooling": HERE / "cooling.cpp", "chain": HERE / "chain.cpp", "suspension": HERE / "suspension.cpp"}
ARM = ["sets.validation_cases=20", "sets.test_cases=50"]
# name, label, settings, has residuals, minimum (None: the best value of all runs), resolution
FIRST = [
    ("hartmann6", "hartmann6", [], False, -3.322368011415515, 1e-8),
    ("constrained", "constrained", [], False, -44.0, 1e-8),
    ("ellipsoid-int", "ellipsoid-int", [], True, 0.0, 1e-8),
    ("speed-control", "speed-control", [], False, None, 1e-8),
    ("kinetics", "kinetics", [], True, None, 1e-8),
    ("cooling", "cooling", [], False, None, 1e-8),
    ("robot", "planar2", ["robot.urdf=planar2.urdf"] + ARM, True, None, 1e-3),
    ("chain", "chain", [], False, None, 1e-8),
]
ARM_OF_THE_THESIS = ["physics.engine=articulated", "task.ik_bug=false"] + ARM
SECOND = [
    ("branin", "branin", [], False, 0.39788735772973816, 1e-8),
    ("sphere", "sphere", [], True, 0.0, 1e-8),
    ("rastrigin", "rastrigin-4", ["function.dimension=4"], True, 0.0, 1e-8),
    ("ackley", "ackley-5", ["function.dimension=5"], False, 0.0, 1e-8),
    ("suspension", "suspension", [], False, None, 1e-8),
    ("q2-e3", "q2-e3", ARM_OF_THE_THESIS, True, None, 1e-4),
    ("q3-load", "q3-load", ARM_OF_THE_THESIS, True, None, 1e-4),
    ("robot", "arm7", ["robot.urdf=arm7.urdf"] + ARM, True, None, 1e-3),
]
CHECKS = {"first": FIRST, "second": SECOND}
ON_TWO_CASES = {"planar2", "q2-e3", "q3-load", "arm7"}


def build(folder):
    libraries = {}
    for name, source in USERS.items():
        library = folder / f"lib{name.replace('-', '_')}.so"
        if not library.exists():
            subprocess.run(["g++", "-std=c++20", "-O2", "-shared", "-fPIC", f"-I{ROOT / 'include'}", str(source), "-o", str(library)],
                           check=True)
        libraries[name] = str(library)
    return libraries


def write_study(path, problem, library, budget, replicates):
    name, label, settings, has_residuals, _, _ = problem
    quote = json.dumps  # TOML's basic strings are JSON's
    text = f"title = {quote('auto on ' + label)}\nreplicates = {replicates}\nbudget = {budget}\nbaselines = false\n"
    text += "start_spread = 1.0\n" if not settings else ""
    pool = list(POOL) + ["auto"] + (["turbo"] if budget <= MOST_TURBO else []) + (["dfls"] if has_residuals else [])
    text += f"optimizers = {quote(pool)}\n"
    if label in ON_TWO_CASES:
        text += 'schedule = "fixed:2"\n'
    text += f"[[problem]]\nname = {quote(library or name)}\nlabel = {quote(label)}\nset = {quote(settings)}\n"
    text += "".join(f"{key} = {quote(value)}\n" for key, value in [("[[optimizer]]\nname", SURROGATE["name"])] + list(SURROGATE.items())[1:])
    path.write_text(text, encoding="utf-8")


def run(problems, folder, budgets, replicates, jobs):
    folder.mkdir(parents=True, exist_ok=True)
    libraries = build(folder)
    for budget in budgets:
        for problem in problems:
            label = problem[1]
            study = folder / f"{label}-{budget}"
            file = folder / f"{label}-{budget}.toml"
            if (study / "tables/pairs.csv").exists():
                continue
            write_study(file, problem, libraries.get(label), budget, replicates)
            print(f"{label}, {budget}", flush=True)
            with open(folder / f"{label}-{budget}.log", "w", encoding="utf-8") as log:
                subprocess.run([PROGRAM, "compare", str(file), "--jobs", str(jobs), "--out", str(study)], stdout=log, stderr=log, check=True)


def read_csv(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def find_choice(study):
    choices = []
    for result in sorted(study.glob("cells/*/auto/r*/result.json")):
        text = json.loads(result.read_text(encoding="utf-8")).get("choice", "")
        choices.append(text.split(" chose ")[1].split(" for ")[0] if " chose " in text else "?")
    return ", ".join(f"{name} ({choices.count(name)})" if len(set(choices)) > 1 else name for name in sorted(set(choices)))


def correct(p_values):
    """Holm's correction of a dict of p-values."""
    corrected, largest = {}, 0.0
    for rank, (name, p) in enumerate(sorted(p_values.items(), key=lambda item: item[1])):
        largest = max(largest, min(1.0, p * (len(p_values) - rank)))
        corrected[name] = largest
    return corrected


def judge(study, known, resolution):
    values = {}
    for row in read_csv(study / "tables/cells.csv"):
        values.setdefault(row["optimizer"], []).append(float(row["value"]) if row["value"] else math.inf)
    medians = {name: statistics.median(all_values) for name, all_values in values.items()}
    best = min((name for name in medians if name != "auto"), key=medians.get)
    p_values = {row["b"] if row["a"] == "auto" else row["a"]: float(row["p"]) for row in read_csv(study / "tables/pairs.csv")
                if "auto" in (row["a"], row["b"])}
    gaps = [max(medians[name] - known, 0.0) for name in ("auto", best)]
    ratio = 1.0 if gaps[0] <= gaps[1] + resolution else gaps[0] / gaps[1] if gaps[1] > 0 else math.inf
    is_worse = medians["auto"] > medians[best] + resolution
    return {"best": best, "p": p_values[best], "holm": correct(p_values)[best], "ratio": ratio, "is_worse": is_worse,
            "gaps": gaps, "replicates": len(values["auto"])}


def make_table(problems, folder):
    rows, good, plain, near, uncorrected = [], 0, 0, 0, 0
    for _, label, _, _, minimum, resolution in problems:
        studies = {int(path.name.rsplit("-", 1)[1]): path for path in folder.glob(f"{label}-*") if (path / "tables/pairs.csv").exists()}
        known = minimum if minimum is not None else min(
            (float(row["value"]) for path in studies.values() for row in read_csv(path / "tables/cells.csv") if row["value"]), default=0.0)
        for budget, study in sorted(studies.items()):
            found = judge(study, known, resolution)
            holds = not (found["is_worse"] and found["holm"] < 0.05)
            is_near = found["ratio"] <= 1.5
            uncorrected += not (found["is_worse"] and found["p"] < 0.05)
            plain, near, good = plain + holds, near + is_near, good + (holds and is_near)
            rows.append(f"| {label} | {budget} | {find_choice(study)} | {found['best']} | {found['gaps'][0]:.3g} | {found['gaps'][1]:.3g} | "
                        f"{found['ratio']:.3g} | {found['p']:.2g} | {found['holm']:.2g} | "
                        f"{'good' if holds and is_near else 'worse' if not holds else 'far'} |")
    head = ["| problem | budget | auto chose | best of the pool | auto's gap | best's gap | ratio | p | p, Holm | verdict |",
            "|---|---|---|---|---|---|---|---|---|---|"]
    count = len(rows)
    tail = ["", f"Not significantly worse than the best of the pool in {plain} of {count} cells ({uncorrected} without Holm's correction); "
            f"within 1.5 times its gap in {near}; both in {good}."]
    return "\n".join(head + rows + tail) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("task", choices=["run", "table"])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--check", choices=sorted(CHECKS), default="second")
    parser.add_argument("--budgets", default="200,1000,5000")
    parser.add_argument("--replicates", type=int, default=10)
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    if arguments.task == "run":
        run(CHECKS[arguments.check], arguments.folder, [int(budget) for budget in arguments.budgets.split(",")], arguments.replicates, arguments.jobs)
    else:
        print(make_table(CHECKS[arguments.check], arguments.folder), end="")


if __name__ == "__main__":
    main()
