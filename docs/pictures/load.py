#!/usr/bin/env python3
"""Chart of scenes/suture/load_*.xml and running.xml: load.py OUT.png ONE TWO THREE RUNNING, the folders of four runs."""
import csv
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

NAMES = ["one stitch", "two stitches", "three stitches", "running suture of five bites"]
LOAD, MIDDLE, END = "skin/right_clamp.reaction.x [N]", "skin/gap_middle.distance [m]", "skin/gap_end.distance [m]"


def main():
    if len(sys.argv) != 2 + len(NAMES):
        sys.exit(__doc__)
    figure, axes = plt.subplots(figsize=(6.4, 4))
    for k, (name, folder) in enumerate(zip(NAMES, sys.argv[2:])):
        with open(os.path.join(folder, "probe.csv"), newline="") as file:
            rows = list(csv.DictReader(file))
        load = [1e3 * float(r[LOAD]) for r in rows]
        axes.plot(load, [1e3 * float(r[END]) for r in rows], color=f"C{k}", label=name)
        axes.plot(load, [1e3 * float(r[MIDDLE]) for r in rows], "--", color=f"C{k}")
    axes.set_xlabel("load of the strip [mN]")
    axes.set_ylabel("gap of the wound [mm]")
    axes.set_title("at the end of the wound (solid) and in its middle (dashed)", fontsize=9)
    axes.set_xlim(0, 350)
    axes.set_ylim(0, 3)
    axes.grid(alpha=0.25)
    axes.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(sys.argv[1], dpi=100)


if __name__ == "__main__":
    main()
