#!/usr/bin/env python3
"""Chart of sutura_bench_opencl. usage: plot_opencl.py DIR

opencl.png: time of a sweep and of a solve with conjugate gradients, on the device, on one core of the CPU, and the floor;
below them, what single precision costs in accuracy. Panels whose CSV file is missing stay out.
"""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = {"double": "C0", "mixed": "C1", "single": "C2"}


def read(path):
    if not path.exists():
        return []
    with open(path) as f:
        return list(csv.DictReader(f))


def points(rows, x, y, **where):
    return [(float(r[x]), float(r[y])) for r in rows if all(r[k] == v for k, v in where.items())]


def line(axis, data, style, **options):
    if data:
        axis.loglog(*zip(*sorted(set(data))), style, markersize=4, **options)


def sweeps(axis, rows, device):
    for way, style in (("one group", "o-"), ("panels", "s--")):
        for precision, colour in COLOURS.items():
            line(axis, points(rows, "contacts", "us a sweep", precision=precision, way=way), style, color=colour,
                 label=f"{precision}, {way}")
        line(axis, points(rows, "contacts", "floor us", precision="double", way=way), style[1:], color="0.7",
             label=f"floor, {way}")
    line(axis, points(rows, "contacts", "CPU us a sweep"), "k^-", label="one core of the CPU")
    axis.set_title(f"a sweep of Gauss-Seidel, {device}", fontsize=9)
    axis.set_xlabel("contacts with friction")
    axis.set_ylabel("us")


def gradients(axis, rows, device):
    for precision, colour in COLOURS.items():
        line(axis, points(rows, "nodes", "solve us", precision=precision), "o-", color=colour, label=precision)
    floor = [(float(r["nodes"]), float(r["iterations"]) * (float(r["product floor us"]) + float(r["P^-1 floor us"])))
             for r in rows if r["precision"] == "double"]
    line(axis, floor, "-", color="0.7", label="floor of products and preconditioner")
    line(axis, points(rows, "nodes", "CPU solve us"), "k^-", label="one core of the CPU")
    axis.set_title(f"conjugate gradients to 1e-4, {device}", fontsize=9)
    axis.set_xlabel("nodes")
    axis.set_ylabel("us")


def sweeps_accuracy(axis, rows, _):
    for precision, colour in COLOURS.items():
        line(axis, points(rows, "contacts", "error of lambda", precision=precision), "o-", color=colour, label=precision)
    axis.axhline(1e-4, color="0.7", linewidth=0.8)
    axis.set_title("lambda after 400 sweeps, against the direct step of the CPU", fontsize=9)
    axis.set_xlabel("contacts with friction")
    axis.set_ylabel("error / largest force")


def gradients_accuracy(axis, rows, _):
    for asked, style in (("0.0001", "s--"), ("1e-08", "o-")):
        for precision, colour in COLOURS.items():
            line(axis, points(rows, "nodes", "error of x", precision=precision, asked=asked), style, color=colour,
                 label=f"{precision}, to {float(asked):.0e}")
    axis.set_title("solution of conjugate gradients, against a factor in double", fontsize=9)
    axis.set_xlabel("nodes")
    axis.set_ylabel("|x - x*| / |x*|")


def main():
    folder = pathlib.Path(sys.argv[1])
    name = folder / "device.txt"
    device = name.read_text().strip() if name.exists() else "unnamed device"
    drawn = [(draw, read(folder / f"{draw.__name__}.csv"))
             for draw in (sweeps, gradients, sweeps_accuracy, gradients_accuracy)]
    drawn = [(draw, rows) for draw, rows in drawn if rows]
    if not drawn:
        return
    lines = (len(drawn) + 1) // 2
    figure, axes = plt.subplots(lines, 2, figsize=(10, 4 * lines), squeeze=False)
    for axis in axes.flat[len(drawn):]:
        axis.axis("off")
    for axis, (draw, rows) in zip(axes.flat, drawn):
        draw(axis, rows, device)
        axis.grid(True, which="major", alpha=0.25)
        axis.legend(fontsize=7, framealpha=0.5)
    figure.tight_layout()
    figure.savefig(folder / "opencl.png", dpi=100)


if __name__ == "__main__":
    main()
