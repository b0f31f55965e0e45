#!/usr/bin/python3
"""slip.py SUTURA [OUT]: draws what two throws hold, scenes/knots/slip.xml at three frictions, as docs/pictures/slip.png."""
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plot  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
EASED = 0.8  # s: from then on the legs are drawn apart


def run(sutura, knot, friction):
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([sutura, "run", ROOT / "scenes/knots/slip.xml", "--output", out, "--lenient", "--duration", "1.3 s", "--set", f"/knot.friction={friction}",
                        "--set", f"/suture.thread_start_file={knot}_start.csv"], check=True, capture_output=True)
        with open(next(pathlib.Path(out).glob("*probe*.csv"))) as probe:
            head, *rows = csv.reader(probe)
    columns = {name.split(" ")[0]: column for name, column in zip(head, zip(*rows))}
    value = lambda name: [float(x) for x in columns[name]]  # noqa: E731
    apart = [b - a for a, b in zip(value("suture.tip_position.x"), value("suture.end_position.x"))]
    force = [1e3 * math.hypot(*f) for f in zip(*(value(f"left.force.{axis}") for axis in "xyz"))]
    begin = next(i for i, t in enumerate(value("time")) if t >= EASED)
    tight = 500 * max(apart)
    missed = sum(x == 0 for x in value("solved"))
    passes = sum(value("passes")) / len(rows)
    print(f"{knot}, mu {friction}: legs {force[begin]:.0f} mN at {EASED} s, then {min(force[begin:]):.0f} to {max(force[begin:]):.0f}, {force[-1]:.0f} at the end; ends in by"
          f" {500 * (apart[begin] - apart[-1]):.2f} mm; {missed} of {len(rows)} steps missed, {passes:.1f} passes each", flush=True)
    return [tight - 500 * x for x in apart[begin:]], force[begin:]


if __name__ == "__main__":
    figure, axes = plot.subplots(figsize=(7.2, 4.2))
    for knot, line in (("square", "-"), ("granny", "--")):
        for friction, colour in ((0.1, "tab:blue"), (0.2, "tab:orange"), (0.3, "tab:red")):
            axes.plot(*run(sys.argv[1], knot, friction), line, color=colour, label=f"{knot}, mu {friction}")
    axes.set(xlabel="ends drawn into the knot [mm]", ylabel="force of a leg [mN]", title="Two throws, each loose end loaded by 20 mN")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(sys.argv[2] if len(sys.argv) > 2 else ROOT / "docs/pictures/slip.png", dpi=100)
