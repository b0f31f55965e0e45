#!/usr/bin/env python3
"""Work-precision chart of the thread with its peers: plot_thread.py FOLDER [OUT.png]

FOLDER holds thread_work_precision.csv (sutura_bench_thread). Peers' figures are published or were measured on the same kind
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


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    folder = sys.argv[1]
    out = sys.argv[2] if len(sys.argv) == 3 else os.path.join(folder, "thread_peers.png")
    with open(os.path.join(folder, "thread_work_precision.csv"), newline="") as file:
        rows = list(csv.DictReader(file))
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
    figure.tight_layout()
    figure.savefig(out, dpi=110)
    print(out)


if __name__ == "__main__":
    main()
