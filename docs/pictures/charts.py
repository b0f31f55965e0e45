#!/usr/bin/env python3
"""Charts of a benchmark's CSV files: charts.py FOLDER draws FOLDER/NAME.png for each NAME.csv it knows.

    *_work_precision.csv   first column: case; a column error...: how wrong; a column cpu... or wall...: what it costs.
                           One line per case, both axes logarithmic: down and left is better.
    *_cost.csv             first column: size of the problem; every other column ending in _ns, _us, _ms or _s: a cost.
    *_convergence.csv      first column: case; second: step or mesh size; a column error...
"""
import csv
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

MARKERS = "osD^vP*X"


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    if not rows:
        sys.exit(f"{path}: no rows")
    return rows, list(rows[0])


def column(names, *starts):
    for name in names:
        if name.startswith(starts):
            return name
    return None


def title(name):
    return name.replace("_", " ")


def by_case(rows, case, x, y):
    cases = {}
    for row in rows:
        cases.setdefault(row[case], []).append((float(row[x]), float(row[y])))
    return cases


def lines(axes, cases):
    for k, (name, points) in enumerate(cases.items()):
        axes.loglog(*zip(*sorted(points)), marker=MARKERS[k % len(MARKERS)], markersize=5, label=name)


def draw(path, folder):
    name = os.path.basename(path)[:-4]
    rows, names = read(path)
    figure, axes = plt.subplots(figsize=(7, 4.6))
    if name.endswith("_work_precision"):
        x, y = column(names, "cpu", "wall"), column(names, "error")
        lines(axes, by_case(rows, names[0], x, y))
    elif name.endswith("_convergence"):
        x, y = names[1], column(names, "error")
        lines(axes, by_case(rows, names[0], x, y))
    else:
        x, y = names[0], "cost"
        costs = [n for n in names[1:] if n.rsplit("_", 1)[-1] in ("ns", "us", "ms", "s")]
        lines(axes, {n: [(float(r[x]), float(r[n])) for r in rows] for n in costs})
    axes.set_xlabel(title(x))
    axes.set_ylabel(title(y))
    axes.set_title(title(name))
    axes.grid(True, which="both", alpha=0.25)
    axes.legend(fontsize=8)
    figure.tight_layout()
    out = os.path.join(folder, name + ".png")
    figure.savefig(out, dpi=110)
    plt.close(figure)
    print(out)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    for file in sorted(os.listdir(sys.argv[1])):
        if file.endswith(("_work_precision.csv", "_cost.csv", "_convergence.csv")):
            draw(os.path.join(sys.argv[1], file), sys.argv[1])


if __name__ == "__main__":
    main()
