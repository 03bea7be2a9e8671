#!/usr/bin/env python3
"""Reads an export in COCO's format bbob-new2, strictly: whatever the format does not allow ends it with a message.

    read_coco.py FOLDER [TARGET ...]      FOLDER holds one root folder for each algorithm

Written from the description of the format and independent of what writes it. Prints what it has read as JSON:
{algId: {"funcId-dimension": {instance: [evaluations, best f - reference, rows in .dat, rows in .tdat]}}}; with targets
{algId: {"funcId-dimension": [expected running time to each target]}}.
"""
import ast
import json
import math
import pathlib
import re
import sys

FIRST_LINE = re.compile(
    r"suite = '([^',]*)', funcId = (\d+), DIM = (\d+), Precision = (\S+), algId = '([^',=]*)', "
    r"coco_version = '(\d+\.\d+\.\d+)', logger = 'bbob', data_format = 'bbob-new2'")
HEADER = re.compile(
    r"% f evaluations \| g evaluations \| best noise-free fitness - (Fopt|Fref) \((-?\d\.\d{12}e[+-]\d\d+)\) "
    r"\+ sum g_i\+ \| measured fitness \| best measured fitness or single-digit g-values \| x1 \| x2\.\.\.")
NUMBER = re.compile(r"[+-]\d\.\d{9}e[+-]\d\d+")
COORDINATE = re.compile(r"[+-]\d\.\d{4}e[+-]\d\d+")


def require(condition, message):
    if not condition:
        sys.exit(f"read_coco.py: {message}")


def read_lines(file):
    text = file.read_text(encoding="utf-8")
    require(not text or text.endswith("\n"), f"{file}: the last line is cut off")
    return text.split("\n")[:-1]


def read_rows(file, dimension):
    """The runs of a data file: of each (reference, rows)."""
    runs = []
    for number, line in enumerate(read_lines(file), 1):
        where = f"{file}:{number}"
        if line.startswith("%"):
            header = HEADER.fullmatch(line)
            require(header, f"{where}: not a header")
            runs.append(((header[1], float(header[2])), []))
            continue
        require(runs, f"{where}: a row without a header")
        fields = line.split(" ")
        shown = dimension if dimension < 7 else 0
        require(len(fields) == 5 + shown, f"{where}: {len(fields)} fields, expected {5 + shown}")
        require(re.fullmatch(r"[1-9]\d*", fields[0]) and re.fullmatch(r"\d+", fields[1]), f"{where}: evaluations")
        require(NUMBER.fullmatch(fields[2]) and NUMBER.fullmatch(fields[3]), f"{where}: fitness")
        require(NUMBER.fullmatch(fields[4]) or re.fullmatch(r"\d+", fields[4]), f"{where}: '{fields[4]}'")
        digits = not NUMBER.fullmatch(fields[4])
        require(fields[1] == "0", f"{where}: cocopp adds evaluations of g to those of f")
        for field in fields[5:]:
            require(COORDINATE.fullmatch(field), f"{where}: x is '{field}'")
        row = (int(fields[0]), float(fields[2]), float(fields[3]), None if digits else float(fields[4]))
        rows = runs[-1][1]
        if rows:
            require(row[0] > rows[-1][0], f"{where}: evaluations do not rise")
            require(row[1] <= rows[-1][1], f"{where}: the best becomes worse")
        require(row[1] >= 0, f"{where}: better than the reference")
        if row[3] is not None:
            require(row[3] <= row[2], f"{where}: the best is worse than this one")
            require(math.isclose(row[3] - runs[-1][0][1], row[1], rel_tol=1e-8, abs_tol=1e-8 * max(1, abs(row[3]))),
                    f"{where}: best - reference is not {row[1]}")
        rows.append(row)
    return runs


def calc_level(difference):
    """The least 10^(k/20) that is not below it, as k."""
    return math.ceil(20 * math.log10(max(difference, 1e-8)))


def check_dat(rows, where):
    require(rows[0][0] == 1, f"{where}: the first evaluation is missing")
    for before, row in zip(rows, rows[1:]):
        if row is not rows[-1]:
            # A difference of exactly a level can round to either side of it in ten digits.
            require(calc_level(row[1] * (1 - 1e-9)) < calc_level(before[1] * (1 + 1e-9)),
                    f"{where}: evaluation {row[0]} reaches no new level")


def check_levels_complete(rows, trows, where):
    """Between two rows of .dat no level may be reached that .tdat knows of."""
    for trow in trows:
        before = [row for row in rows if row[0] <= trow[0]][-1]
        require(before[0] == trow[0] or calc_level(before[1] * (1 - 1e-9)) <= calc_level(trow[1] * (1 + 1e-9)),
                f"{where}: evaluation {trow[0]} is below the level of the .dat's row {before[0]}")


def list_triggers(evaluations, dimension):
    """Which numbers of evaluations must have a row in .tdat."""
    numbers = {evaluations}
    for k in range(0, 400):
        numbers.add(math.floor(10 ** (k / 20)))
    for power in range(0, 20):
        numbers |= {factor * dimension * 10 ** power for factor in (1, 2, 5)}
    return sorted(number for number in numbers if number <= evaluations)


def read_block(lines, root, file):
    first = FIRST_LINE.fullmatch(lines[0])
    require(first, f"{file}: the first line is {lines[0]}")
    require(first[1] == "armwright", f"{file}: suite {first[1]}")
    function, dimension = int(first[2]), int(first[3])
    # cocopp has groups of its own for 1 to 24, and takes numbers above 92 for noisy functions or leaves them out.
    require(25 <= function <= 92, f"{file}: funcId {function}")
    require(float(first[4]) == 1e-8 and re.fullmatch(r"\d\.\d{3}e-\d\d", first[4]), f"{file}: Precision {first[4]}")
    require(first[5] and first[5] == first[5].strip(), f"{file}: algId '{first[5]}'")
    require(lines[1].startswith("% "), f"{file}: the second line is no comment")
    parts = lines[2].split(", ")
    require(parts[0] == f"data_f{function}/bbobexp_f{function}_DIM{dimension}.dat", f"{file}: data {parts[0]}")
    instances = []
    for part in parts[1:]:
        entry = re.fullmatch(r"([1-9]\d*):([1-9]\d*)\|(\d\.\de[+-]\d\d+)", part)
        require(entry, f"{file}: '{part}'")
        instances.append((int(entry[1]), int(entry[2]), entry[3]))
    require(instances, f"{file}: no instances")
    data = root / parts[0]
    files = [data.with_suffix(ending) for ending in (".dat", ".tdat", ".rdat", ".mdat")]
    dat, tdat, rdat, mdat = (read_rows(one, dimension) for one in files)
    require(len(dat) == len(tdat) == len(instances), f"{data}: {len(dat)} runs, the index has {len(instances)}")
    for runs in (rdat, mdat):
        require(not runs or [run[0] for run in runs] == [run[0] for run in dat],
                f"{data}: .rdat and .mdat have other runs")
    result = {}
    hits = []
    for i, (instance, evaluations, shown) in enumerate(instances):
        where = f"{data}: run {i + 1}"
        require(dat[i][0] == tdat[i][0], f"{where}: the references differ")
        rows, trows = dat[i][1], tdat[i][1]
        require(rows and trows, f"{where}: no rows")
        check_dat(rows, where)
        check_levels_complete(rows, trows, where)
        triggers = list_triggers(evaluations, dimension)
        require([row[0] for row in trows] == triggers,
                f"{where}: .tdat has rows at {[row[0] for row in trows]}, expected {triggers}")
        require(rows[-1] == trows[-1], f"{where}: the last rows of .dat and .tdat differ")
        require(rows[-1][0] == evaluations, f"{where}: the last row is {rows[-1][0]}, the index says {evaluations}")
        require(f"{rows[-1][1]:.1e}" == shown, f"{where}: best {rows[-1][1]}, the index says {shown}")
        require(dat[i][0][0] in lines[1] and ("known" in lines[1]) == (dat[i][0][0] == "Fopt"),
                f"{file}: the comment names another source than {dat[i][0][0]}")
        result.setdefault(instance, []).append([evaluations, rows[-1][1], len(rows), len(trows)])
        hits.append([(row[0], row[1]) for row in rows])
    require(all(len(runs) == 1 for runs in result.values()), f"{file}: an instance stands there twice")
    references = {run[0] for run in dat}
    return first[5], function, dimension, references, {key: runs[0] for key, runs in result.items()}, files, hits


def calc_ert(hits, target):
    """The evaluations of all runs up to their hit or end, divided by the number of hits; None without a hit."""
    spent = hit = 0
    for rows in hits:
        reached = [evaluation for evaluation, difference in rows if difference <= target]
        spent += reached[0] if reached else rows[-1][0]
        hit += bool(reached)
    return spent / hit if hit else None


def read_names(script):
    """The names of the functions, which the export's program tells cocopp."""
    tree = ast.parse(script.read_text(encoding="utf-8"))
    values = {node.targets[0].id: node.value for node in tree.body
              if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)}
    return ast.literal_eval(values["FUNCTIONS"]), ast.literal_eval(values["DIMENSIONS"])


def main():
    require(len(sys.argv) >= 2, "usage: read_coco.py FOLDER [TARGET ...]")
    targets = [float(word) for word in sys.argv[2:]]
    result = {}
    references = {}
    best = {}
    folder = pathlib.Path(sys.argv[1])
    names, dimensions = read_names(folder / "run_cocopp.py")
    for root in sorted(folder.iterdir()):
        if root.name == "run_cocopp.py":
            continue
        require(root.is_dir(), f"{root}: a stray file")
        read = set()
        for file in sorted(root.glob("*.info")):
            lines = read_lines(file)
            require(len(lines) % 3 == 0 and lines, f"{file}: {len(lines)} lines, expected three a function and dimension")
            read.add(file)
            for i in range(0, len(lines), 3):
                algorithm, function, dimension, found, runs, files, hits = read_block(lines[i:i + 3], root, file)
                require(file.name == f"bbobexp_f{function}.info", f"{file}: holds function {function}")
                require(function in names and dimension in dimensions, f"{file}: run_cocopp.py lacks it")
                key = f"{function}-{dimension}"
                functions = result.setdefault(algorithm, {})
                require(key not in functions, f"{file}: function {key} has been there before")
                # Each run may have its own known optimum. Where it is unknown, all runs have the same reference.
                kinds = {kind for kind, _ in found}
                require(len(kinds) == 1 and (kinds == {"Fopt"} or len(found) == 1), f"{file}: references {found}")
                if kinds == {"Fref"}:
                    require(references.setdefault(key, found) == found, f"{file}: the references differ")
                    best.setdefault(key, []).extend(run[1] for run in runs.values())
                functions[key] = [calc_ert(hits, target) for target in targets] if targets else runs
                read |= set(files)
        for file in root.rglob("*"):
            require(file.is_dir() or file in read, f"{file}: a stray file")
    require(result, "no algorithm")
    for key, differences in best.items():
        nothing_feasible = references[key] == {("Fref", 0.0)} and min(differences) == 1e10
        require(min(differences) == 0 or nothing_feasible, f"function {key}: no run reaches the reference")
    json.dump(result, sys.stdout)


main()
