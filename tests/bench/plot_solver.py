#!/usr/bin/env python3
"""Charts of sutura_bench_solver. usage: plot_solver.py DIR

solver.png: residual against time, one panel per problem.
"""
import csv
import math
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def race(folder, name):
    curves = {}
    with open(folder / f"{name}.csv") as f:
        for row in csv.DictReader(f):
            curve = curves.setdefault((row["problem"], row["rows"]), {})
            points = curve.setdefault((row["solver"], row["start"]), [])
            residual = float(row["residual"])
            if math.isfinite(residual):
                points.append((float(row["time ms"]), max(residual, 1e-12)))
    columns = min(3, len(curves))
    lines = math.ceil(len(curves) / columns)
    figure, axes = plt.subplots(lines, columns, figsize=(5 * columns, 3.6 * lines), squeeze=False)
    names = sorted({name for curve in curves.values() for name, _ in curve})
    colours = {name: f"C{i}" for i, name in enumerate(names)}
    for axis in axes.flat[len(curves):]:
        axis.axis("off")
    for axis, ((problem, rows), curve) in zip(axes.flat, curves.items()):
        for (solver, start), points in curve.items():
            axis.loglog(*zip(*points), "o-" if start == "cold" else "s--", color=colours[solver], markersize=3,
                        label=f"{solver}, {start}")
        axis.axhline(1e-3, color="0.7", linewidth=0.8)
        axis.set_title(f"{problem} ({rows} rows)", fontsize=9)
        axis.set_xlabel("time (ms)")
        axis.set_ylabel("law residual")
    figure.legend(*axes.flat[0].get_legend_handles_labels(), loc="lower center", ncol=5, fontsize=8)
    figure.tight_layout(rect=(0, 0.18 / lines, 1, 1))
    figure.savefig(folder / f"{name}.svg")
    figure.savefig(folder / f"{name}.png", dpi=120)


def main():
    folder = pathlib.Path(sys.argv[1])
    race(folder, "solver")
    race(folder, "solver_scenes")


if __name__ == "__main__":
    main()
