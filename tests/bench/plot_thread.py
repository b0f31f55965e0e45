#!/usr/bin/env python3
"""Charts of the thread: plot_thread.py FOLDER

FOLDER holds the files of sutura_bench_thread. Draws there
  thread_peers.png      thread_work_precision.csv with its peers
  thread_sampling.png   thread_sampling.csv: a tight loop, adaptive against uniform beams

Peers' figures are published or were measured on the same kind
of machine, one thread: see docs/theory/thread.md and the table PEERS below.
"""
import csv
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# case: (name, microseconds per step, error over L)
PEERS = {
    "suture cantilever": [
        ("PositionBasedDynamics, direct rods, 50 segments", 54, 0.03e-3 / 0.2),
        ("dismech (discrete elastic rods), 50 segments", 3600, 0.17e-3 / 0.2),
    ],
    # SOFA's adaptive beams: error at 4, 16, 64 beams; time measured for 50 and 200 beams, 3.8 us per beam.
    "elastica load 10": [
        ("SOFA BeamAdapter, 4 beams", 4 * 3.8, 6e-3),
        ("SOFA BeamAdapter, 16 beams", 16 * 3.8, 3.7e-4),
        ("SOFA BeamAdapter, 64 beams", 64 * 3.8, 6.5e-5),
    ],
    "elastica load 1": [("SOFA BeamAdapter, 16 beams", 16 * 3.8, 1.6e-5)],
}


def read(folder, name):
    with open(os.path.join(folder, name), newline="") as file:
        return list(csv.DictReader(file))


def save(figure, folder, name, bottom=0):
    out = os.path.join(folder, name)
    figure.tight_layout(rect=(0, bottom, 1, 1))
    figure.savefig(out, dpi=110)
    print(out)


def peers(folder):
    rows = read(folder, "thread_work_precision.csv")
    cases = list(dict.fromkeys(row["case"] for row in rows))
    figure, panels = plt.subplots(1, len(cases), figsize=(4.4 * len(cases), 4.2), sharey=True)
    for axes, case in zip(panels, cases):
        points = [(float(r["cpu_us_per_step"]), float(r["error_over_L"]), r["beams"]) for r in rows if r["case"] == case]
        axes.loglog([p[0] for p in points], [p[1] for p in points], "o-", label="sutura")
        for x, y, beams in points:
            axes.annotate(beams, (x, y), textcoords="offset points", xytext=(4, 4), fontsize=7)
        for (name, x, y), marker in zip(PEERS.get(case, []), "s^vD"):
            axes.loglog([x], [y], marker, color="gray", label=name)
        axes.set_title(case)
        axes.set_xlabel("CPU time per step [us]")
        axes.grid(True, which="both", alpha=0.25)
        axes.legend(fontsize=7)
    panels[0].set_ylabel("tip error / L")
    save(figure, folder, "thread_peers.png")


def sampling(folder):
    rows = read(folder, "thread_sampling.csv")
    figure, panels = plt.subplots(1, 2, figsize=(9.6, 4.4), sharey=True)
    for axes, x in zip(panels, ("beams", "cpu_us_per_step")):
        for quantity, colour in (("height", "tab:blue"), ("curvature", "tab:red")):
            for kind, style in (("uniform", "s--"), ("adaptive", "o-")):
                points = [(float(r[x]), float(r[quantity + "_error"]), r["angle_rad"]) for r in rows if r["sampling"] == kind]
                axes.loglog(*zip(*[p[:2] for p in points]), style, color=colour, markersize=4, label=f"{quantity}, {kind}")
                for px, py, angle in points if (kind, quantity) == ("adaptive", "height") else []:
                    axes.annotate(angle, (px, py), textcoords="offset points", xytext=(-6, -10), fontsize=7, ha="right")
        axes.margins(x=0.12)
        axes.set_xlabel({"beams": "beams", "cpu_us_per_step": "CPU time per step [us]"}[x])
        axes.grid(True, which="both", alpha=0.25)
    panels[0].set_ylabel("relative error")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="lower center", ncol=4, fontsize=8)
    figure.suptitle("A 300 mm thread in a loop of 1 mm radius (numbers: sampling_angle, rad)", fontsize=10)
    save(figure, folder, "thread_sampling.png", bottom=0.06)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    peers(sys.argv[1])
    sampling(sys.argv[1])


if __name__ == "__main__":
    main()
