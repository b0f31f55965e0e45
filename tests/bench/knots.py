#!/usr/bin/python3
"""Where an overhand knot that is drawn together can be trusted, and what its force costs: knots.py SUTURA FOLDER [--only map|rod|work] [--jobs N] [--limit S]

map   scenes/knots/overhand.xml drawn from e = 165 to 16 diameters (e: by how much the thread is longer than its ends are apart), at
      several steps, speeds and frictions: the share of the steps that miss their tolerance, until e = 27 diameters and after that.
rod   an overhand knot in a rod of 0.9 m and 3.2 mm with E 0.18 MPa, drawn at 60 mm/s to e = 27 diameters, dt 2.5 ms, 300 beams: time
      of a step on one core and the pull at the end, with finer beams and steps to compare. Two runs at a time at most.
work  the same drawn to 27 diameters within 0.3 s and held: error of the pull against processor time for a simulated second, over the
      length of the step, the number of beams, sampling, the tolerance, and with a knot that may become rigid. Each is the mean of several draws, which differ by
      a damping of no account: which touches carry the force is chaotic. The reference has the shortest step, the most beams and a
      tenth of the tolerance.

Writes FOLDER/map.csv, FOLDER/work.csv and their charts, and FOLDER/rod.csv.
"""
import argparse
import concurrent.futures
import csv
import math
import os
import pathlib
import shutil
import statistics
import subprocess
import tempfile

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plot  # noqa: E402

KNOTS = pathlib.Path(__file__).resolve().parents[2] / "scenes" / "knots"
LENGTH, DIAMETER = 56.557, 0.2          # of the thread, mm
WAY = (21.090, -9.519, -15.085)         # of the hand in the scene, mm: to e = 27 diameters
TIGHT, LOOSE = 27, 16                   # e / d: the two ends of the second half of a draw
STEPS = (1, 2.5, 5, 10, 20, 50)         # ms
SPEEDS = (1, 10, 100, 1000)             # mm/s
FRICTIONS = (0, 0.1, 0.3)


def drawn(sutura, limit, settings, speed, excess, rest):
    """One run: a dict with its steps as columns, and seconds of the processor. The setting "Knots" adds that component."""
    settings = dict(settings)
    knots = settings.pop("Knots", "")
    length = math.hypot(*WAY)
    way = [x * (length + (TIGHT - excess) * DIAMETER) / length for x in WAY]
    time = math.hypot(*way) / speed
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder) / "overhand.xml"
        scene.write_text((KNOTS / "overhand.xml").read_text().replace("<Contact friction", f"{knots}<Contact friction"))
        shutil.copy(KNOTS / "overhand_start.csv", folder)
        command = [sutura, "run", scene, "--lenient", "--output", folder, "--duration", f"{time + rest} s",
                   "--set", "/vtu_recorder.interval=1e9", "--set", f"/way.times=0 {time}",
                   "--set", f"/way.positions=0 0 0 {' '.join(str(1e-3 * x) for x in way)}"]
        for name, value in settings.items():
            command += ["--set", f"{name}={value}"]
        child = subprocess.Popen(["timeout", str(limit), *command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        with open(pathlib.Path(folder) / "probe.csv") as probe:
            head, *rows = csv.reader(probe)
    rows = [[float(x) for x in row] for row in rows if len(row) == len(head)]
    columns = {name.split(" ")[0]: column for name, column in zip(head, zip(*rows))}
    return {"time": columns["time"], "solved": columns["solved"], "passes": columns["passes"],
            "force": [1e3 * math.hypot(*f) for f in zip(*(columns[f"left.force.{axis}"] for axis in "xyz"))],
            "excess": [TIGHT + (length - min(speed * t, math.hypot(*way))) / DIAMETER for t in columns["time"]],
            "drawn_in": time, "complete": child.returncode == 0, "seconds": used.ru_utime + used.ru_stime}


def missed(run, of):
    steps = [solved for solved, excess in zip(run["solved"], run["excess"]) if of(excess)]
    return 100 * sum(x == 0 for x in steps) / len(steps) if steps else math.nan


def one_of_map(sutura, limit, friction, speed, dt):
    run = drawn(sutura, limit, {".dt": f"{dt} ms", "/contact.friction": friction}, speed, LOOSE, 0.1)
    held = [force for t, force in zip(run["time"], run["force"]) if t > run["drawn_in"]]
    return {"friction": friction, "speed": speed, "dt": dt, "steps": len(run["time"]), "complete": int(run["complete"]),
            "missed_loose": missed(run, lambda e: e > TIGHT), "missed_tight": missed(run, lambda e: e <= TIGHT),
            "passes": statistics.mean(run["passes"]), "pull": statistics.mean(held) if held else math.nan, "ms": 1e3 * run["seconds"] / len(run["time"])}


def one_of_work(sutura, limit, name, settings, draw):
    settings = {**settings, "/suture.damping_mass": f"{1e-3 * draw} 1/s", "/way.easing": "smooth"}
    run = drawn(sutura, limit, settings, 92, TIGHT, 0.4)
    held = [force for t, force in zip(run["time"], run["force"]) if t > run["drawn_in"] + 0.2]
    if not run["complete"] or not held:
        raise RuntimeError(f"{name}: not run to its end")
    return {"name": name, "draw": draw, "pull": statistics.mean(held), "missed": missed(run, lambda _: True),
            "passes": statistics.mean(run["passes"]), "seconds": run["seconds"] / run["time"][-1]}


def work_settings():
    """Line of the chart, name of the point, settings."""
    for dt in (1.25, 2.5, 5, 10, 20):
        yield "step", f"{dt} ms", {".dt": f"{dt} ms"}
    for beams in (140, 200, 280, 400, 560):
        yield "beams", f"{beams} beams", {"/suture.thread_beams": beams}
    for angle, shortest in ((0.4, 0.2), (0.3, 0.2), (0.2, 0.1), (0.1, 0.1)):
        yield "sampled", f"{angle} rad", {"/suture.thread_beams": 70, "/suture.sampling_angle": f"{angle} rad", "/suture.shortest_beam": f"{shortest} mm"}
    for tolerance in (0.1, 0.03, 0.01, 0.003, 0.001):
        yield "tolerance", f"tolerance {tolerance}", {".tolerance": tolerance}
    yield "sampled", "0.3 rad, tolerance 0.001", {"/suture.thread_beams": 70, "/suture.sampling_angle": "0.3 rad", "/suture.shortest_beam": "0.2 mm", ".tolerance": 0.001}
    yield "rigid", "rigid", {"Knots": '<Knots rigidify="true"/>'}
    yield "reference", "reference", {".dt": "1.25 ms", "/suture.thread_beams": 560, ".tolerance": 0.001}


ROD_SCENE = """<?xml version="1.0"?>
<sutura version="1" dt="2.5 ms" gravity="0 0 0" duration="{duration} s">
  <plugin name="thread"/> <plugin name="tools"/> <plugin name="contact"/> <plugin name="output"/>
  <SutureThread name="suture" needle_length="0" thread_young="0.18 MPa" thread_density="1180" thread_diameter="3.2 mm"
                damping_stiffness="1 ms" damping_mass="10 1/s" thread_length="{length} mm" thread_beams="300" tip_direction="-1 0 0" thread_start_file="start.csv"/>
  <Contact friction="0.1"/>
  <Track name="still" times="0" positions="0 0 0"/>
  <Grasper name="left" at="0" track="still" rotation_stiffness="0"/>
  <Track name="way" times="0 {drawn} s" positions="0 0 0  {way} mm" easing="smooth"/>
  <Grasper name="right" at="{length} mm" track="way" rotation_stiffness="0"/>
  <CsvProbe report="true" columns="/left.force /contact.touches"/>
</sutura>
"""


def one_of_rod(sutura, limit, name, settings):
    size = 3.2 / DIAMETER
    drawn_in = size * math.hypot(*WAY) / 60
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        with open(KNOTS / "overhand_start.csv") as start, open(folder / "start.csv", "w") as out:
            head, *rows = csv.reader(start)
            table = csv.writer(out)
            table.writerow(head)
            for s, curvature, torsion in rows:
                table.writerow([size * float(s), float(curvature) / size, float(torsion) / size])
        (folder / "rod.xml").write_text(ROD_SCENE.format(length=size * LENGTH, drawn=drawn_in, duration=drawn_in + 2,
                                                         way=" ".join(str(size * x) for x in WAY)))
        command = ["timeout", str(limit), sutura, "run", folder / "rod.xml", "--lenient", "--output", folder / "out"]
        for key, value in settings.items():
            command += ["--set", f"{key}={value}"]
        child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        with open(folder / "out" / "probe.csv") as probe:
            head, *rows = csv.reader(probe)
    rows = [row for row in rows if len(row) == len(head)]
    columns = {name.split(" ")[0]: [float(x) for x in column] for name, column in zip(head, zip(*rows))}
    force = [1e3 * math.hypot(*f) for f in zip(*(columns[f"left.force.{axis}"] for axis in "xyz"))]
    held = [f for t, f in zip(columns["time"], force) if t > drawn_in + 0.5]
    return {"name": name, "steps": len(rows), "missed": sum(x == 0 for x in columns["solved"]), "passes": statistics.mean(columns["passes"]),
            "touches": max(columns["contact.touches"]), "pull": statistics.mean(held) if held else math.nan,
            "ms": 1e3 * (used.ru_utime + used.ru_stime) / len(rows)}


def rod_settings():
    yield "300 beams", {}
    yield "300 beams, 10 ms", {".dt": "10 ms"}
    yield "sampled", {"/suture.thread_beams": 70, "/suture.sampling_angle": "0.3 rad", "/suture.shortest_beam": "3.2 mm"}
    yield "sampled, 10 ms", {"/suture.thread_beams": 70, "/suture.sampling_angle": "0.3 rad", "/suture.shortest_beam": "3.2 mm", ".dt": "10 ms"}
    yield "600 beams, 1.25 ms", {"/suture.thread_beams": 600, ".dt": "1.25 ms", ".tolerance": 0.001}


def write(path, rows):
    with open(path, "w") as file:
        table = csv.DictWriter(file, rows[0].keys())
        table.writeheader()
        table.writerows(rows)


def run_all(pool, function, jobs):
    futures = [pool.submit(function, *job) for job in jobs]
    rows = []
    for future in futures:
        try:
            rows.append(future.result())
            print(", ".join(f"{k} {v:.4g}" if isinstance(v, float) else f"{k} {v}" for k, v in rows[-1].items()), flush=True)
        except (RuntimeError, OSError) as error:
            print(error, flush=True)
    return rows


def draw_map(rows, path):
    figure, axes = plot.subplots(1, len(FRICTIONS), figsize=(11, 3.6), sharey=True)
    for axis, friction in zip(axes, FRICTIONS):
        for row in (r for r in rows if r["friction"] == friction):
            x, y = SPEEDS.index(row["speed"]), STEPS.index(row["dt"])
            for half, share in ((0, row["missed_loose"]), (0.5, row["missed_tight"])):
                colour = "lightgrey" if math.isnan(share) else plot.cm.RdYlGn_r(min(1.0, share / 50))
                axis.add_patch(plot.Rectangle((x + half, y), 0.5, 1, color=colour, linewidth=0))
                if not math.isnan(share):
                    axis.text(x + half + 0.25, y + 0.5, f"{share:.0f}{'' if row['complete'] else '*'}", ha="center", va="center", fontsize=8)
        axis.set(xlim=(0, len(SPEEDS)), ylim=(0, len(STEPS)), title=f"friction {friction}", xlabel="speed of the hand [mm/s]")
        axis.set_xticks([i + 0.5 for i in range(len(SPEEDS))], [str(s) for s in SPEEDS])
        axis.set_yticks([i + 0.5 for i in range(len(STEPS))], [str(s) for s in STEPS])
    axes[0].set_ylabel("step [ms]")
    figure.suptitle("Overhand knot: steps that miss their tolerance, in %; left until e = 27 diameters, right from there to 16 (*: cut off)", fontsize=10)
    figure.tight_layout()
    figure.savefig(path, dpi=100)


def draw_work(rows, path):
    means = {}
    for line, name, _ in work_settings():
        of_it = [r for r in rows if r["name"] == name]
        if of_it:
            pulls = [r["pull"] for r in of_it]
            spread = statistics.stdev(pulls) / math.sqrt(len(pulls)) if len(pulls) > 1 else 0
            means[line, name] = (statistics.mean(pulls), spread, statistics.mean(r["seconds"] for r in of_it))
    reference, spread_of_it, _ = means["reference", "reference"]
    print(f"reference {reference:.2f} mN, standard error of the mean {spread_of_it:.2f}")
    figure, axis = plot.subplots(figsize=(8, 4.8))
    for line, marker in (("step", "o-"), ("beams", "s-"), ("sampled", "v-"), ("tolerance", "^-"), ("rigid", "D")):
        points = [(seconds, 100 * (pull / reference - 1), 100 * spread / reference, name)
                  for (of, name), (pull, spread, seconds) in means.items() if of == line]
        if not points:
            continue
        axis.errorbar([p[0] for p in points], [p[1] for p in points], yerr=[p[2] for p in points], fmt=marker, capsize=3, label=line)
        for seconds, error, spread, name in points:
            axis.annotate(name.replace("tolerance ", "").replace(" beams", ""), (seconds, error), fontsize=7, xytext=(5, 5), textcoords="offset points")
            print(f"{name}: {error:+.1f} +- {spread:.1f} %, {seconds:.2f} s for a simulated second")
    axis.axhspan(-100 * spread_of_it / reference, 100 * spread_of_it / reference, color="grey", alpha=0.2)
    axis.set(xlabel="processor time for a simulated second [s]", ylabel="error of the pull [%]", title="Overhand knot at e = 27 diameters, friction 0.3")
    axis.grid(alpha=0.3)
    axis.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=100)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sutura")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--only", choices=("map", "rod", "work"))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--draws", type=int, default=4)
    parser.add_argument("--limit", type=float, default=600, help="time that a run may take, s")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        if options.only in (None, "rod"):
            few = concurrent.futures.ThreadPoolExecutor(min(2, options.jobs))  # more share the memory of the machine
            write(options.folder / "rod.csv", run_all(few, one_of_rod, [(options.sutura, options.limit, *of) for of in rod_settings()]))
        if options.only in (None, "map"):
            jobs = [(options.sutura, options.limit, friction, speed, dt) for speed in SPEEDS for dt in STEPS for friction in FRICTIONS]
            rows = run_all(pool, one_of_map, jobs)
            write(options.folder / "map.csv", rows)
            draw_map(rows, options.folder / "knot_map.png")
        if options.only in (None, "work"):
            jobs = [(options.sutura, options.limit, name, settings, draw) for _, name, settings in work_settings() for draw in range(options.draws)]
            rows = run_all(pool, one_of_work, jobs)
            write(options.folder / "work.csv", rows)
            draw_work(rows, options.folder / "knot_work_precision.png")
