#!/usr/bin/python3
"""How much knots of two, three and four throws hold, over friction: holding.py SUTURA FOLDER [--jobs N] [--limit S]

Each is laid out by scenes/knots/lay_knot.py with a sampled thread. Its ends are drawn with 140 mN, which is eased to 20 mN, and from 0.9 s
on the legs of its loop are drawn apart at 5 mm/s by hands that give way by 10 mm per newton. It has slipped when the ends have come in by
half a millimetre since; where they do not, it has held what the run ended with.

Writes FOLDER/holding.csv and FOLDER/holding.png. Scenes and results that are in FOLDER already are taken as they are.
"""
import argparse
import concurrent.futures
import csv
import math
import pathlib
import subprocess
import sys

KNOTS = pathlib.Path(__file__).resolve().parents[2] / "scenes" / "knots"
THROWS = {"+-": "square", "+-+": "three throws", "+-+-": "four throws", "++": "granny", "+++": "granny of three"}
FRICTIONS = (0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3)
EASED, SLIPPED = 0.9, 0.5  # s, mm

SCENE = """<?xml version="1.0"?>
<sutura version="1" dt="5 ms" gravity="0 0 0" duration="2.2 s">
  <plugin name="thread"/> <plugin name="tools"/> <plugin name="contact"/> <plugin name="output"/>
  <SutureThread name="suture" needle_length="0" thread_young="2 GPa" thread_density="1100" thread_diameter="0.2 mm"
                bending_factor="0.05" damping_stiffness="0.1 ms" damping_mass="20 1/s" thread_length="{length} mm"
                thread_beams="{beams}" sampling_angle="0.3 rad" shortest_beam="0.2 mm" tip="{tip} mm"
                tip_direction="{side} 0 0" plane_normal="0 -1 0" thread_start_file="{start}"/>
  <Contact name="knot" friction="{friction}"/>
  <ThreadLoad name="first" at="0" force="{first} 0 0 N" times="0 0.5 0.7 0.9 s" factors="0 1 1 0.143"/>
  <ThreadLoad name="last" at="{length} mm" force="{last} 0 0 N" times="0 0.5 0.7 0.9 s" factors="0 1 1 0.143"/>
  <Track name="left_way" times="0 0.5 0.9 2.9 s" positions="0 0 0  -1.4 0 0  -1.4 0 0  -11.4 0 0 mm"/>
  <Track name="right_way" times="0 0.5 0.9 2.9 s" positions="0 0 0  1.4 0 0  1.4 0 0  11.4 0 0 mm"/>
  <Grasper name="left" track="left_way" at="{left} mm" stiffness="100 N/m" rotation_stiffness="0"/>
  <Grasper name="right" track="right_way" at="{right} mm" stiffness="100 N/m" rotation_stiffness="0"/>
  <CsvProbe report="true" columns="/left.force /suture.tip_position /suture.end_position"/>
</sutura>
"""


def lay(folder):
    """Writes the scenes, with their threads."""
    sys.path.insert(0, str(KNOTS))
    import lay_knot
    for hands in THROWS:
        if (folder / f"{hands}_0.xml").exists():
            continue
        said = lay_knot.main(hands, folder / f"{hands}.csv")
        side = 1 if said["tip"][0] > 0 else -1
        for friction in FRICTIONS:
            text = SCENE.format(start=f"{hands}.csv", friction=friction, side=side, first=0.14 * side, last=-0.14 * side,
                                beams=round(said["length"] / 0.82), length=round(said["length"], 3), left=round(said["left"], 3),
                                right=round(said["right"], 3), tip=" ".join(str(round(x, 4)) for x in said["tip"]))
            (folder / f"{hands}_{friction}.xml").write_text(text)


def run(sutura, folder, limit, hands, friction):
    out = folder / f"{hands}_{friction}"
    if not (out / "done").exists():
        finished = subprocess.run(["timeout", str(limit), sutura, "run", folder / f"{hands}_{friction}.xml", "--lenient", "--output", out],
                                  capture_output=True, text=True)
        if not (out / "probe.csv").exists():
            raise RuntimeError(finished.stderr)
        (out / "done").write_text(finished.stdout)
    with open(out / "probe.csv") as probe:
        head, *rows = csv.reader(probe)
    columns = {name.split(" ")[0]: [float(row[i]) for row in rows if len(row) == len(head)] for i, name in enumerate(head)}
    begin = next((i for i, t in enumerate(columns["time"]) if t >= EASED), None)
    if begin is None:
        print(f"{hands} with friction {friction} was cut off before its legs are drawn apart", flush=True)
        return None
    force = [1e3 * math.hypot(*f) for f in zip(*(columns[f"left.force.{axis}"] for axis in "xyz"))]
    ends = [abs(a - b) for a, b in zip(columns["suture.tip_position.x"], columns["suture.end_position.x"])]
    slip = [500 * (ends[begin] - e) for e in ends]  # of each end, mm
    slipped = next((i for i in range(begin, len(slip)) if slip[i] > SLIPPED), None)
    row = {"hands": hands, "friction": friction, "force": round(force[-1 if slipped is None else slipped], 1), "slips": int(slipped is not None),
           "missed": sum(x == 0 for x in columns["solved"]), "steps": len(force), "passes": round(sum(columns["passes"]) / len(force), 1)}
    print(row, flush=True)
    return row


def draw(rows, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plot
    figure, axes = plot.subplots(figsize=(7.2, 4.2))
    for (hands, name), line in zip(THROWS.items(), ("o-", "s-", "D-", "o--", "s--")):
        points = sorted((r["friction"], r["force"], r["slips"]) for r in rows if r["hands"] == hands)
        drawn, = axes.plot([p[0] for p in points], [p[1] for p in points], line, label=name, markersize=5)
        for x, y, slips in points:
            if not slips:
                axes.annotate("", (x, 1.25 * y), (x, y), arrowprops={"arrowstyle": "->", "color": drawn.get_color()})
    axes.set(xlabel="friction", ylabel="force of a leg [mN]", yscale="log", title="What knots hold before their ends have slipped in by 0.5 mm (arrows: they have not)")
    axes.title.set_fontsize(9)
    axes.set_yticks([20, 50, 100, 200, 500], ["20", "50", "100", "200", "500"])
    axes.grid(alpha=0.3, which="both")
    axes.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=100)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sutura")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--limit", type=float, default=600, help="time that a run may take, s")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    lay(options.folder)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        rows = pool.map(lambda job: run(options.sutura, options.folder, options.limit, *job), [(h, f) for f in reversed(FRICTIONS) for h in THROWS])
        table = [row for row in rows if row is not None]
    with open(options.folder / "holding.csv", "w") as file:
        writer = csv.DictWriter(file, table[0].keys())
        writer.writeheader()
        writer.writerows(table)
    draw(table, options.folder / "holding.png")
