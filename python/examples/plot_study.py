"""Reads a study and plots its curves: the objective of the incumbent on the test set, as the median over the replicates.

    /usr/bin/python3 plot_study.py [STUDY_FOLDER [PICTURE]]

Without a folder, it first makes a small study in results/plot_study, which takes seconds. It needs python3-matplotlib.
"""
import sys

import armwright
import matplotlib
import numpy as np

matplotlib.use("Agg")  # draws without a window
from matplotlib import pyplot  # noqa: E402

picture = sys.argv[2] if len(sys.argv) > 2 else "study.png"
if len(sys.argv) > 1:
    study = armwright.load_study(sys.argv[1])
else:
    study = armwright.compare(["sphere", "rosenbrock"], ["cmaes", "ga"], replicates=6, budget=300, set={"function.dimension": 4},
                              out="results/plot_study")
figure, panels = pyplot.subplots(1, len(study.problems), figsize=(5 * len(study.problems), 4), squeeze=False)
for panel, problem in zip(panels[0], study.problems):
    for optimizer in study.optimizers:
        curves = study.curves(problem, optimizer)  # replicates x checkpoints; infinite before the first incumbent
        style = "--" if optimizer in study.baselines else "-"
        panel.plot(study.checkpoints(problem), np.median(curves, axis=0), style, label=optimizer)
    panel.set(title=problem, xlabel="simulated training cases", ylabel="value on the test set", xscale="log", yscale="log")
panels[0][0].legend()
figure.tight_layout()
figure.savefig(picture)
print(f"{picture} shows {study.folder}")
print("\n".join(study.verdict))
