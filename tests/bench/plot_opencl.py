#!/usr/bin/env python3
"""Chart of sutura_bench_opencl. usage: plot_opencl.py DIR

opencl.png: time of a sweep, of a solve with conjugate gradients and of a whole step, on the device and on one core of the
CPU; every kernel of a step beside its floor; what single precision costs in accuracy. Panels whose CSV file is missing
stay out.
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


def step(axis, rows, device):
    for (way, style) in (("CPU", "k^-"), ("device", "C0o--"), ("device, contacts too", "C0o-")):
        line(axis, points(rows, "nodes", "step ms", way=way), style, label=way)
    line(axis, [(20000, 16), (50000, 33)], "r_", label="aim")
    axis.set_title(f"a whole step, 300 contacts, {device}", fontsize=9)
    axis.set_xlabel("nodes")
    axis.set_ylabel("ms")


def step_kernels(axis, rows, _):
    sizes = sorted({int(r["nodes"]) for r in rows})
    nodes = str(sizes[len(sizes) // 2])
    kernels = sorted((r for r in rows if r["nodes"] == nodes and float(r["us a step"]) > 20),
                     key=lambda r: float(r["us a step"]))
    names = [r["kernel"] for r in kernels]
    for column, colour, label in (("us a step", "C0", "from first item to last"), ("launches us", "C1", "its launches"),
                                  ("floor us", "0.3", "its bytes over the bandwidth")):
        width = 0.8 if column == "us a step" else 0.4
        offset = {"us a step": 0, "launches us": 0.2, "floor us": -0.2}[column]
        axis.barh([i + offset for i in range(len(names))], [float(r[column]) for r in kernels], height=width,
                  color=colour, label=label)
    axis.set_yticks(range(len(names)), names, fontsize=6)
    axis.set_xscale("log")
    axis.set_xlim(left=1)
    axis.set_title(f"kernels of a step, {nodes} nodes", fontsize=9)
    axis.set_xlabel("us a step")


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
             for draw in (sweeps, gradients, step, step_kernels, sweeps_accuracy, gradients_accuracy)]
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
