#!/usr/bin/python3
"""Draws the data profile of dfls and DFO-LS: the share of problems that are solved within a budget.

  benchmarks/more_wild/data_profile.py           writes docs/images/data-profile.svg from dfls.csv and dfols.csv beside it
  benchmarks/more_wild/data_profile.py --check   fails if that picture, or the table in docs/dfls.md, is not that of the files

A data profile (More and Wild 2009) counts evaluations in units of n + 1, those of one simplex.
"""

import csv
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
ROOT = FOLDER.parents[1]
PICTURE = ROOT / "docs/images/data-profile.svg"
PAGE = ROOT / "docs/dfls.md"
TAUS = ("1e-1", "1e-3", "1e-5")
BUDGETS = (3, 5, 10, 20, 50)  # simplices
LEFT, TOP, WIDTH, HEIGHT = 60, 40, 560, 300
COLOURS = {"dfls": "#0b6e99", "DFO-LS": "#b3541e"}
DASHES = {"1e-1": "2 4", "1e-3": "8 4", "1e-5": ""}


def read_table(name):
    """Returns the rows of a table; lines that begin with # are comments."""
    with open(FOLDER / name, encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def list_costs(rows, tau):
    """Returns the simplices that each solved problem took, in ascending order."""
    return sorted(int(row[f"tau_{tau}"]) / (int(row["n"]) + 1) for row in rows if row[f"tau_{tau}"])


def count_solved(rows, tau, simplices):
    return sum(cost <= simplices for cost in list_costs(rows, tau))


def draw(tables):
    longest = BUDGETS[-1]

    def place(simplices, share):
        return f"{LEFT + WIDTH * simplices / longest:.1f},{TOP + HEIGHT * (1 - share):.1f}"

    parts = []
    for share in (0, 0.25, 0.5, 0.75, 1):
        y = TOP + HEIGHT * (1 - share)
        parts.append(f'<path class="grid" d="M{LEFT} {y:.1f}h{WIDTH}"/>')
        parts.append(f'<text x="{LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">{share:.0%}</text>')
    for simplices in range(0, longest + 1, 10):
        x = LEFT + WIDTH * simplices / longest
        parts.append(f'<text x="{x:.1f}" y="{TOP + HEIGHT + 18}" text-anchor="middle">{simplices}</text>')
    row = 0
    for name, rows in tables.items():
        for tau in TAUS:
            points, solved = [place(0, 0)], 0
            for cost in list_costs(rows, tau):
                points += [place(cost, solved / len(rows)), place(cost, (solved + 1) / len(rows))]
                solved += 1
            points.append(place(longest, solved / len(rows)))
            line = f'stroke="{COLOURS[name]}" stroke-dasharray="{DASHES[tau]}"'
            parts.append(f'<polyline class="line" {line} points="{" ".join(points)}"><title>{name}, tau = {tau}</title></polyline>')
            y = TOP + HEIGHT - 112 + 18 * row
            parts.append(f'<path class="line" {line} d="M{LEFT + WIDTH - 170} {y}h40"/>')
            parts.append(f'<text x="{LEFT + WIDTH - 122}" y="{y + 4}">{name}, tau = {tau}</text>')
            row += 1
    width, height = LEFT + WIDTH + 20, TOP + HEIGHT + 48
    style = "text{font:13px system-ui,sans-serif;fill:#1b2733}.grid{stroke:#d5dee6}.line{fill:none;stroke-width:2}"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" role="img" '
        f'aria-label="Data profile of dfls and DFO-LS">\n<style>{style}</style>\n<rect width="{width}" height="{height}" fill="#fff"/>\n'
        f'<text x="{LEFT}" y="24">Share of the 53 problems that are solved</text>\n' + "\n".join(parts) + "\n"
        f'<text x="{LEFT + WIDTH / 2}" y="{height - 10}" text-anchor="middle">evaluations / (n + 1)</text>\n</svg>\n'
    )


def tabulate(tables):
    """Returns the table of solved problems in Markdown."""
    lines = ["| program | tau | " + " | ".join(f"{budget} (n + 1)" for budget in BUDGETS) + " |", "|---|---|" + "---|" * len(BUDGETS)]
    for tau in TAUS:
        for name, rows in tables.items():
            counts = " | ".join(str(count_solved(rows, tau, budget)) for budget in BUDGETS)
            lines.append(f"| {name} | {tau} | {counts} |")
    return "\n".join(lines) + "\n"


def main():
    tables = {"dfls": read_table("dfls.csv"), "DFO-LS": read_table("dfols.csv")}
    picture, table = draw(tables), tabulate(tables)
    if sys.argv[1:] == ["--check"]:
        faults = []
        if PICTURE.read_text(encoding="utf-8") != picture:
            faults.append(f"{PICTURE.relative_to(ROOT)} is not that of the tables; run benchmarks/more_wild/data_profile.py")
        if table not in PAGE.read_text(encoding="utf-8"):
            faults.append(f"{PAGE.relative_to(ROOT)} lacks this table:\n{table}")
        sys.exit("\n".join(faults) or 0)
    PICTURE.write_text(picture, encoding="utf-8")
    print(table, end="")


if __name__ == "__main__":
    main()
