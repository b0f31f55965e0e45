#!/usr/bin/env python3
"""Error against time of whole runs: step.py SUTURA FOLDER

Each scene at several steps, once with the passes that its tolerance asks for and once with a single pass a step, as a
program does that linearises once; the thread also with BDF2. The error is that against the same scene at a quarter of its shortest step, with a
tolerance of 1e-4. Writes FOLDER/step_work_precision.csv and FOLDER/step_convergence.csv.
"""
import csv
import math
import os
import re
import subprocess
import sys

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")

SWUNG = """<sutura version="1" dt="10 ms" gravity="0 0 -9.81" duration="0.6 s">
  <plugin name="thread"/> <plugin name="tools"/> <plugin name="output"/>
  <SutureThread name="suture" needle_length="0" tip="0 0 0" tip_direction="-0.3 0 1" thread="4-0 polypropylene"
                thread_length="60 mm" thread_beams="40" damping_mass="5 1/s"/>
  <Track name="hand" times="0 0.1 0.2 s" positions="0 0 0  0 60 0  0 0 20 mm" easing="smooth"/>
  <Grasper at="0" track="hand"/>
  <CsvProbe columns="/suture.end_position"/>
</sutura>
"""

HANGING = """<sutura version="1" dt="10 ms" gravity="0 0 -9.81" duration="0.4 s">
  <plugin name="tissue"/> <plugin name="output"/>
  <BlockMesh box="0 0 0  10 10 40 mm" cells="3 3 12"/>
  <Tissue name="tissue" young="3 kPa" poisson="0.45" density="1000" damping_stiffness="10 ms"/>
  <Attach box="0 0 40  10 10 40 mm"/>
  <TissueProbe name="end" point="5 5 0 mm"/>
  <CsvProbe columns="/end.position"/>
</sutura>
"""

STITCH = os.path.join(ROOT, "scenes", "suture", "first_stitch.xml")

# name, scene, steps (ms), columns of the result, time at which it is read (s)
CASES = [
    ("swung thread, its end (m)", SWUNG, (20, 10, 5, 2.5, 1.25, 0.625), "suture.end_position", 0.6),
    ("block let go under its weight, its end (m)", HANGING, (20, 10, 5, 2.5, 1.25, 0.625), "end.position", 0.4),
    ("first stitch, thread drawn in at 4 s (m)", STITCH, (20, 10, 5, 2.5), "path.entry_abscissa", 4),
]
ONE_PASS = (", one pass a step", ["--set", ".passes=1", "--set", ".substeps=1", "--lenient"])
SECOND_ORDER = (", second order in time", ["--set", ".time_order=2"])  # steps without rows, of threads alone


def run(sutura, scene, folder, dt, columns, time, options):
    if scene.startswith("<"):
        path = os.path.join(folder, "scene.xml")
        with open(path, "w") as file:
            file.write(scene)
    else:
        path = scene
        options = [*options, "--set", "/vtu_recorder.interval=1e9"]
    out = os.path.join(folder, "run")
    done = subprocess.run([sutura, "run", path, "--set", f".dt={dt} ms", "--duration", f"{time} s", "--output", out, *options],
                          capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{path} at {dt} ms: {done.stdout}{done.stderr}")
    seconds = float(re.search(r"simulated in ([-+.e0-9]+) s", done.stdout).group(1))
    name = next(f for f in sorted(os.listdir(out)) if f.endswith(".csv"))
    with open(os.path.join(out, name), newline="") as file:
        last = list(csv.DictReader(file))[-1]
    return [float(v) for k, v in last.items() if k.startswith((columns + ".", columns + " "))], seconds


def main():
    sutura, folder = sys.argv[1:]
    os.makedirs(folder, exist_ok=True)
    rows = []
    for name, scene, steps, columns, time in CASES:
        modes, best = [("", []), ONE_PASS], []
        if scene is SWUNG:
            modes.append(SECOND_ORDER)
            best = SECOND_ORDER[1]
        exact, _ = run(sutura, scene, folder, steps[-1] / 4, columns, time, ["--set", ".tolerance=1e-4", *best])
        for mode, options in modes:
            for dt in steps:
                found, seconds = run(sutura, scene, folder, dt, columns, time, options)
                rows.append((name + mode, dt, math.dist(found, exact), seconds))
                print("%-60s %6g ms: error %.3g, %.3g s" % rows[-1], flush=True)
    for file, head, picked in (("work_precision", ("case", "error", "wall [s]"), (0, 2, 3)),
                               ("convergence", ("case", "step [ms]", "error"), (0, 1, 2))):
        with open(os.path.join(folder, f"step_{file}.csv"), "w", newline="") as out:
            writer = csv.writer(out)
            writer.writerow(head)
            writer.writerows([row[i] for i in picked] for row in rows)


main()
