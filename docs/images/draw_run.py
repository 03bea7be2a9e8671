#!/usr/bin/env python3
"""Draws a run of q1-complex as SVG: the winner's motion on one test case, and the error over the generations.

Usage: python3 docs/images/draw_run.py results/q1-complex-ga-seed1 > docs/images/q1-complex.svg
"""
import csv
import json
import math
import sys
from pathlib import Path

WIDTH, HEIGHT, MARGIN = 900, 380, 50
PANEL = (WIDTH - 3 * MARGIN) / 2


def read_csv(path):
    with open(path, newline="") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def arm_points(q2, q3, q4):
    """Shoulder, elbow, wrist and tip in the arm's vertical plane (m); dimensions of the IRB 4600-40/2.55."""
    shoulder = (0.175, 0.495)
    elbow = (shoulder[0] + 1.095 * math.sin(q2), shoulder[1] + 1.095 * math.cos(q2))
    a, b = q2 + q3, q2 + q3 + q4
    wrist = (elbow[0] + 1.270 * math.cos(a) + 0.175 * math.sin(a),
             elbow[1] - 1.270 * math.sin(a) + 0.175 * math.cos(a))
    return [(0, 0), (0, 0.495), shoulder, elbow, wrist,
            (wrist[0] + 0.135 * math.cos(b), wrist[1] - 0.135 * math.sin(b))]


def polyline(points, colour, width, opacity=1.0):
    text = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return (f'<polyline points="{text}" fill="none" stroke="{colour}" stroke-width="{width}" '
            f'stroke-opacity="{opacity}" stroke-linejoin="round" stroke-linecap="round"/>')


def label(x, y, text, anchor="middle", size=12, colour="#333"):
    return (f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}" '
            f'fill="{colour}">{text}</text>')


def draw_motion(rows):
    scale = PANEL / 2.7

    def place(point):
        return MARGIN + (point[0] + 0.3) * scale, HEIGHT - MARGIN - point[1] * scale

    def posture(row):
        return [place(p) for p in arm_points(*(row[f"joint_{k}_q_rad"] for k in (2, 3, 4)))]

    path = [place((math.hypot(row["tip_x_m"], row["tip_y_m"]), row["tip_z_m"])) for row in rows]
    parts = [polyline(posture(row), "#f08030", 9, 0.13) for row in rows[60::190]]
    parts += [polyline(path, "#2060b0", 1.2, 0.8), polyline(posture(rows[-1]), "#f06000", 9)]
    parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="#444"/>' for x, y in posture(rows[-1])[2:5]]
    parts.append(polyline([place((-0.25, 0)), place((2.35, 0))], "#888", 1.5))
    parts.append(label(MARGIN + PANEL / 2, HEIGHT - 18, "the winner on a test case, seen from its side: arm and path of the tip"))
    return parts


def draw_convergence(rows, result):
    left, top, bottom = 2 * MARGIN + PANEL, 30, HEIGHT - MARGIN
    generations = rows[-1]["generation"]
    low, high = math.log10(3), math.log10(60)

    def place(generation, error_m):
        share = (math.log10(min(max(1e3 * error_m, 3), 60)) - low) / (high - low)
        return left + generation / generations * PANEL, bottom - share * (bottom - top)

    parts = [polyline([(left, top), (left, bottom), (left + PANEL, bottom)], "#888", 1.2)]
    for error in (3, 5, 10, 20, 50):
        x, y = place(0, error / 1e3)
        parts += [polyline([(x - 4, y), (x, y)], "#888", 1.2), label(x - 8, y + 4, f"{error} mm", "end")]
    for generation in range(0, int(generations) + 1, 100):
        x, _ = place(generation, 0.003)
        parts.append(label(x, bottom + 16, str(generation)))
    parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="1.5" fill="#2060b0" fill-opacity="0.6"/>'
              for x, y in (place(row["generation"], row["best_objective"]) for row in rows)]
    published = result["published"]["error_m"]
    test = result["winner"]["test_summary"]["mean"]
    winner = result["candidates"][result["winner"]["candidate"]]
    (x0, y0), (x1, _) = place(0, published), place(generations, published)
    parts.append(polyline([(x0, y0), (x1, y0)], "#b02020", 1.2, 0.8))
    parts.append(label(x1, y0 - 90, f"published: {1e3 * published:.1f} mm (line)", "end", colour="#b02020"))
    x, y = place(winner["generation"], test)
    parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="6" fill="#f06000"/>')
    parts.append(label(x1, y0 - 110, f"our winner on 500 unseen cases: {1e3 * test:.2f} mm (dot)", "end", colour="#c05000"))
    parts.append(label(left + PANEL / 2, HEIGHT - 18, "best error of each generation, on a new test case every time"))
    return parts


def main():
    folder = Path(sys.argv[1])
    result = json.loads((folder / "result.json").read_text())
    parts = draw_motion(read_csv(folder / "winner-trajectory.csv"))
    parts += draw_convergence(read_csv(folder / "convergence.csv"), result)
    print(f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" '
          f'viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif">')
    print(f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>')
    print("\n".join(parts))
    print("</svg>")


if __name__ == "__main__":
    main()
