#!/usr/bin/env python3
"""Charts of sutura_bench_tissue. usage: plot_tissue.py DIR

tissue_steps.png: time per step against nodes. tissue_age.png: iterations against what happened since the factor was made.
Error against time of the element types is drawn by docs/pictures/charts.py.
"""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def read(path):
    if not path.exists():
        return []
    with open(path) as f:
        return list(csv.DictReader(f))


def steps(folder):
    rows = read(folder / "tissue_steps.csv")
    if not rows:
        return
    figure, axis = plt.subplots(figsize=(6, 4.2))
    for k, element in enumerate(("t4", "smoothed")):
        for j, solver in enumerate(dict.fromkeys(r["solver"] for r in rows)):
            points = [(float(r["nodes"]), float(r["cpu ms"])) for r in rows if r["solver"] == solver and r["element"] == element]
            if points:
                axis.loglog(*zip(*points), "os"[k] + "-:"[k], color=f"C{j}", markersize=4, label=f"{element}, {solver}")
    axis.axhline(16, color="0.7", linewidth=0.8)
    axis.text(1.02, 16, "16 ms", transform=axis.get_yaxis_transform(), fontsize=7, va="center")
    axis.set_xlabel("nodes")
    axis.set_ylabel("main worker per step (ms)")
    axis.set_title("pad under a moving tool, two solves a step, residual 1e-4", fontsize=9)
    axis.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(folder / "tissue_steps.png", dpi=130)


def age(folder):
    rows = [r for r in read(folder / "tissue_age.csv") if float(r["h ms"]) == 10]
    if not rows:
        return
    states = list(dict.fromkeys(r["state"] for r in rows))
    kinds = list(dict.fromkeys(r["preconditioner"] for r in rows))
    figure, axis = plt.subplots(figsize=(6.5, 3.8))
    width = 0.8 / len(kinds)
    for k, kind in enumerate(kinds):
        count = {r["state"]: float(r["iterations 1e-6"]) for r in rows if r["preconditioner"] == kind}
        at = [i + (k - (len(kinds) - 1) / 2) * width for i in range(len(states))]
        bars = axis.bar(at, [count[s] for s in states], width, label=kind)
        axis.bar_label(bars, fmt="%d", fontsize=6)
    axis.set_yscale("log")
    axis.set_xticks(range(len(states)), states, fontsize=8)
    axis.set_ylabel("iterations to 1e-6")
    axis.set_title("factor of the state at rest, 3520 nodes, h = 10 ms", fontsize=9)
    axis.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(folder / "tissue_age.png", dpi=130)


if __name__ == "__main__":
    out = pathlib.Path(sys.argv[1])
    steps(out)
    age(out)
