"""Optimizes a function of your own with one optimizer, then compares three.

    python3 own_problem.py [BUDGET]
"""
import sys
from typing import Any

import armwright


def spring(x: Any) -> tuple[float, float, float]:
    """The mass of a coil spring, in kg, with its stress as a constraint. The force is 500 N, the travel 30 mm."""
    wire_mm, coil_mm, turns = x
    rate = 81500 * wire_mm**4 / (8 * coil_mm**3 * turns)  # N/mm
    stress = 8 * 500 * coil_mm / (3.1416 * wire_mm**3)  # MPa
    mass = 7.85e-6 * 0.7854 * wire_mm**2 * 3.1416 * coil_mm * turns
    return mass, stress, abs(rate * 30 - 500)


problem = armwright.make_problem(
    spring, [2, 20, 3], [12, 80, 20], names=["wire", "coil", "turns"], name="spring", objectives=[armwright.Objective("mass", "kg")],
    constraints=[armwright.Constraint("stress", "MPa", limit=700), armwright.Constraint("force_error", "N", limit=25)])

if __name__ == "__main__":
    budget = int(sys.argv[1]) if len(sys.argv) > 1 else 2000
    run = armwright.optimize(problem, "cmaes", budget=budget, out="results/spring")
    print("cmaes:", "no spring meets both limits" if run.x is None else f"{run.value:.4f} kg with {run.x.round(2)}")
    study = armwright.compare([problem], ["ga", "cmaes", "random"], replicates=3, budget=budget, out="results/springs")
    print(*study.verdict, sep="\n")
    print(f"armwright report {study.folder} makes the page")
