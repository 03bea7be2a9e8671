#!/usr/bin/env python3
"""Reads an export in IOHprofiler's JSON format, strictly: whatever the format does not allow ends it with a message.

    read_ioh.py FOLDER [TARGET ...]      FOLDER holds one root folder for each algorithm

Written from the description of the format and independent of what writes it. Prints what it has read as JSON:
{algorithm: {problem: {instance: [evaluations, best y, rows]}}}; with targets
{algorithm: {"funcId-dimension": [expected running time to each target]}}.
"""
import json
import math
import pathlib
import re
import sys


def require(condition, message):
    if not condition:
        sys.exit(f"read_ioh.py: {message}")


def parse_strictly(file):
    def refuse(word):
        require(False, f"{file}: {word} is no JSON")

    def unique(pairs):
        keys = [key for key, _ in pairs]
        require(len(keys) == len(set(keys)), f"{file}: a key stands there twice")
        return dict(pairs)

    return json.loads(file.read_text(encoding="utf-8"), parse_constant=refuse, object_pairs_hook=unique)


def is_int(value):
    return isinstance(value, int) and not isinstance(value, bool)


def is_number(value):
    return is_int(value) or isinstance(value, float) and math.isfinite(value)


def parse_value(text, where):
    if text in ("None", "inf"):
        return math.inf
    require(re.fullmatch(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", text), f"{where}: '{text}' is no number")
    return float(text)


def read_dat(file, attributes, dimension):
    """The runs of a .dat file: of each its rows."""
    header = attributes + [f"x{i}" for i in range(dimension)]
    runs = []
    text = file.read_text(encoding="ascii")
    require(text.endswith("\n"), f"{file}: the last line is cut off")
    for number, line in enumerate(text.splitlines(), 1):
        where = f"{file}:{number}"
        require(line == line.strip() and "  " not in line and "\t" not in line, f"{where}: single blanks separate")
        fields = line.split(" ")
        require(len(fields) == len(header), f"{where}: {len(fields)} fields, the header has {len(header)}")
        if not re.search(r"\d", fields[0]):  # how readers tell a header
            require(fields == header, f"{where}: the header is {fields}, expected {header}")
            require(not runs or runs[-1], f"{where}: the run before has no rows")
            runs.append([])
            continue
        require(runs, f"{where}: a row without a header")
        require(re.fullmatch(r"[1-9]\d*", fields[0]), f"{where}: evaluations is '{fields[0]}'")
        row = [int(fields[0])] + [parse_value(field, where) for field in fields[1:]]
        require(not runs[-1] or row[0] > runs[-1][-1][0], f"{where}: evaluations do not rise")
        runs[-1].append(row)
    require(runs and runs[-1], f"{file}: the last run has no rows")
    return runs


def check_run(run, rows, dimension, run_attributes, where):
    known = {"instance", "evals", "best"} | set(run_attributes)
    require(set(run) == known, f"{where}: a run has the keys {sorted(run)}, expected {sorted(known)}")
    require(is_int(run["instance"]) and run["instance"] >= 1, f"{where}: instance is {run['instance']}")
    require(is_int(run["evals"]) and run["evals"] >= 1, f"{where}: evals is {run['evals']}")
    for name in run_attributes:
        require(is_number(run[name]), f"{where}: the run's {name} is no number")
    best = run["best"]
    require(set(best) == {"evals", "y", "x"}, f"{where}: best has the keys {sorted(best)}")
    require(is_int(best["evals"]) and 1 <= best["evals"] <= run["evals"], f"{where}: best.evals is {best['evals']}")
    require(is_number(best["y"]), f"{where}: best.y is {best['y']}")
    require(len(best["x"]) == dimension and all(map(is_number, best["x"])), f"{where}: best.x is {best['x']}")
    require(rows[0][0] == 1, f"{where}: the first row is {rows[0][0]}, and readers count runs by evaluation 1")
    require(rows[-1][0] == run["evals"], f"{where}: the last row is {rows[-1][0]}, evals {run['evals']}")
    lowest = math.inf
    for row in rows:
        if row is not rows[-1] and row is not rows[0]:
            require(row[1] < lowest, f"{where}: row {row[0]} is neither an improvement nor the first or the last")
        if row[1] < lowest:
            lowest = row[1]
            lowest_row = row
    if math.isfinite(lowest):
        require(best["y"] == lowest, f"{where}: best.y is {best['y']}, the rows' {lowest}")
        require(best["evals"] == lowest_row[0], f"{where}: best.evals is {best['evals']}, the rows' {lowest_row[0]}")
        require(best["x"] == lowest_row[-dimension:], f"{where}: best.x is not that of its row")


def read_index(file, root):
    index = parse_strictly(file)
    needed = {"version", "suite", "function_id", "function_name", "maximization", "algorithm", "attributes", "scenarios"}
    optional = {"experiment_attributes", "run_attributes"}
    require(needed <= set(index) <= needed | optional, f"{file}: keys {sorted(index)}")
    require(isinstance(index["version"], str) and index["version"] >= "0.3.3", f"{file}: version {index['version']}")
    require(isinstance(index["suite"], str) and index["suite"], f"{file}: suite")
    require(is_int(index["function_id"]) and index["function_id"] >= 1, f"{file}: function_id")
    require(isinstance(index["function_name"], str), f"{file}: function_name")
    require(index["maximization"] is False, f"{file}: objectives are minimised")
    require(set(index["algorithm"]) == {"name", "info"}, f"{file}: algorithm")
    require(all(isinstance(text, str) for text in index["algorithm"].values()), f"{file}: algorithm")
    for attribute in index.get("experiment_attributes", []):
        require(len(attribute) == 1 and all(isinstance(v, str) for v in attribute.values()), f"{file}: {attribute}")
        # iohinspector evaluates the text as Python; a list, a function, ... would be no column of its table.
        try:
            value = eval(next(iter(attribute.values())))
        except Exception:
            value = ""
        require(isinstance(value, (bool, int, float, str)), f"{file}: {attribute} is no plain value")
    name = re.fullmatch(r"IOHprofiler_f(\d+)_([A-Za-z0-9_.-]+)\.json", file.name)
    require(name, f"{file}: not a portable name")
    require(int(name[1]) == index["function_id"], f"{file}: function_id is {index['function_id']}")
    stem = f"f{name[1]}_{name[2]}"
    attributes = index["attributes"]
    require(attributes[:2] == ["evaluations", "raw_y"], f"{file}: attributes begin with {attributes[:2]}")
    require(len(set(attributes)) == len(attributes), f"{file}: a column stands there twice")
    for attribute in attributes:
        require(re.fullmatch(r"[A-Za-z]\w*", attribute, re.ASCII), f"{file}: column '{attribute}'")
        require(not re.fullmatch(r"x\d+", attribute), f"{file}: column '{attribute}' looks like a variable")
    dimensions = [scenario["dimension"] for scenario in index["scenarios"]]
    require(dimensions and len(set(dimensions)) == len(dimensions), f"{file}: dimensions {dimensions}")
    problems = {}
    hits = {}
    read = {file}
    for scenario in index["scenarios"]:
        require(set(scenario) == {"dimension", "path", "runs", "problem", "variables"},
                f"{file}: a scenario has {sorted(scenario)}")
        require(len(scenario["variables"]) == scenario["dimension"], f"{file}: {len(scenario['variables'])} variables")
        dimension = scenario["dimension"]
        require(is_int(dimension) and dimension >= 1, f"{file}: dimension {dimension}")
        expected = f"data_{stem}/IOHprofiler_f{index['function_id']}_DIM{dimension}.dat"
        require(scenario["path"] == expected, f"{file}: path {scenario['path']}, expected {expected}")
        data = root / scenario["path"]
        rows = read_dat(data, attributes, dimension)
        require(len(rows) == len(scenario["runs"]), f"{data}: {len(rows)} runs, the index has {len(scenario['runs'])}")
        require(scenario["problem"] not in problems, f"{file}: problem {scenario['problem']} stands there twice")
        runs = problems.setdefault(scenario["problem"], {})
        hits[f"{index['function_id']}-{dimension}"] = rows
        for i, run in enumerate(scenario["runs"]):
            check_run(run, rows[i], dimension, index.get("run_attributes", []), f"{data}: run {i + 1}")
            require(run["instance"] not in runs, f"{file}: instance {run['instance']} stands there twice")
            runs[run["instance"]] = [run["evals"], run["best"]["y"], len(rows[i])]
        read.add(data)
    return index, problems, read, hits


def calc_ert(runs, target):
    """The evaluations of all runs up to their hit or end, divided by the number of hits; None without a hit."""
    spent = hit = 0
    for rows in runs:
        reached = [row[0] for row in rows if row[1] <= target]
        spent += reached[0] if reached else rows[-1][0]
        hit += bool(reached)
    return spent / hit if hit else None


def main():
    require(len(sys.argv) >= 2, "usage: read_ioh.py FOLDER [TARGET ...]")
    targets = [float(word) for word in sys.argv[2:]]
    folder = pathlib.Path(sys.argv[1])
    result = {}
    ids = {}
    for root in sorted(folder.iterdir()):
        require(root.is_dir(), f"{root}: a stray file")
        read = set()
        names = set()
        for file in sorted(root.glob("*.json")):
            index, problems, files, hits = read_index(file, root)
            names.add(index["algorithm"]["name"])
            functions = result.setdefault(index["algorithm"]["name"], {})
            new = {key: [calc_ert(runs, target) for target in targets] for key, runs in hits.items()} if targets else problems
            require(not set(new) & set(functions), f"{file}: {sorted(new)} has been there before")
            require(ids.setdefault(index["function_name"], index["function_id"]) == index["function_id"],
                    f"{file}: the function has another id elsewhere")
            functions.update(new)
            read |= files
        require(len(names) == 1, f"{root}: holds the algorithms {sorted(names)}, not one")
        for file in root.rglob("*"):
            require(file.is_dir() or file in read, f"{file}: a stray file")
    require(len(set(ids.values())) == len(ids), f"functions share an id: {ids}")
    require(result, f"{folder}: holds no algorithm")
    json.dump(result, sys.stdout)


main()
