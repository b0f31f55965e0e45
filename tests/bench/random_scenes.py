#!/usr/bin/python3
"""random_scenes.py SUTURA [--seeds 1-100] [--jobs N] [--limit S]: makes scenes at random and runs each at its step and at an eighth of that.

Three of five are threads (10-0 to 2, monofilaments and braids, with and without a needle) that one or two hands carry about at up to
1 m/s, let go and grasp again; the others are curved needles that are driven into a block of 2 to 300 kPa. Steps are 1 to 50 ms.
A line for each scene, and at the end how many ended with which exit code and how many were wrong without a word: code 0, but another
number of punctures than at an eighth of the step, or more than five times its largest strain (and above 0.02 %) where no note says that
it is not known how taut the thread is, or not finite.
"""
import argparse
import concurrent.futures
import csv
import math
import pathlib
import random
import subprocess
import tempfile

HEAD = '<sutura version="1" dt="{dt:.10g} ms" gravity="0 0 -9.81" duration="{duration:.10g} s">\n'
HEAD += "".join(f'  <plugin name="{p}"/>\n' for p in ("thread", "tissue", "suturing", "tools", "output"))


def between(r, low, high):
    return math.exp(r.uniform(math.log(low), math.log(high)))


def suture(r, more):
    braid = r.random() < 0.4
    return (f'  <SutureThread name="suture" thread_young="{between(r, 1, 4):.3g} GPa" thread_density="{r.uniform(900, 1400):.0f}"\n'
            f'    thread_diameter="{between(r, 20, 500):.1f} um" bending_factor="{between(r, 0.01, 0.1) if braid else 1:.3g}"\n'
            f'    damping_stiffness="{between(r, 0.01, 1):.2g} ms" thread_beams="{r.randint(20, 150)}" {more}/>\n')


def way(r, name, steps):
    """A track of random key frames, at up to 1 m/s, and how long it takes (s)."""
    at, time, times, positions = [0.0, 0.0, 0.0], 0.0, ["0"], ["0 0 0"]
    for _ in range(steps):
        to = [r.uniform(-30, 30) for _ in at]
        time += math.dist(at, to) / between(r, 50, 1000)
        at = to
        times.append(f"{time:.4f}")
        positions.append(" ".join(f"{x:.2f}" for x in at))
    return f'  <Track name="{name}" times="{" ".join(times)} s" positions="{"  ".join(positions)} mm"/>\n', time


def thread_scene(r):
    length, needle = between(r, 40, 300), r.random() < 0.5
    first, duration = way(r, "first_way", r.randint(1, 3))
    second, _ = way(r, "second_way", r.randint(1, 3))
    duration = min(0.8, duration + r.uniform(0.1, 0.3))
    shape = 'needle="13 mm 1/2 circle"' if needle else 'needle_length="0"'
    text = suture(r, f'{shape} thread_length="{length:.1f} mm" thread_bend_radius="{r.uniform(10, 40):.0f} mm"')
    change = r.uniform(0.2, 0.8) * duration
    hands = f'  <Grasper name="first" track="first_way" at="{r.uniform(1, 10):.1f} mm" release="{change:.3f} s"/>\n'
    if r.random() < 0.7:
        when = change + r.uniform(-0.1, 0.1) * duration
        hands += f'  <Grasper name="second" track="second_way" at="{r.uniform(0.3, 0.9) * length:.1f} mm" grasp="{max(0, when):.3f} s"/>\n'
    return text + first + second + hands, duration


def needle_scene(r):
    threshold, turn = between(r, 0.05, 0.5), r.uniform(40, 160)
    duration = r.uniform(0.4, 1.2)
    text = ('  <node name="skin">\n    <BlockMesh box="-15 -8 -10  15 8 0 mm" cells="12 6 5"/>\n    <AsyncPreconditioner lag="3"/>\n'
            f'    <Tissue name="tissue" young="{between(r, 2, 300):.3g} kPa" poisson="{r.uniform(0.2, 0.45):.2f}" density="1000" '
            'damping_stiffness="10 ms"/>\n    <Attach box="-15 -8 -10  15 8 -10 mm"/>\n  </node>\n')
    text += suture(r, 'needle_length="26 mm" needle_angle="180 deg" needle_diameter="0.65 mm" tip="-7.36 0 1.22 mm" tip_direction="0.457 0 -0.889" '
                      f'plane_normal="0 -1 0" thread_length="{r.uniform(30, 100):.0f} mm" thread_direction="0.1 0 1" thread_bend_radius="15 mm"')
    text += f'  <Track name="turn" centre="0 0 5 mm" times="0.05 {duration:.3f} s" rotations="0 0 0  0 {-turn:.1f} 0 deg" easing="smooth"/>\n'
    release = f' release="{r.uniform(0.4, 1) * duration:.3f} s"' if r.random() < 0.5 else ""
    text += f'  <Grasper name="first" track="turn" at="23 mm"{release}/>\n'
    text += (f'  <Puncture threshold="{threshold:.3f} N" exit_threshold="{r.uniform(0.5, 1) * threshold:.3f} N" friction="0.2"/>\n'
             f'  <Cutting threshold="{between(r, 0.02, 0.2):.3f} N"/>\n  <SuturePath name="path" spacing="1 mm"/>\n'
             f'  <PathFriction coefficient="{r.uniform(0.05, 0.5):.2f}" pressure="{between(r, 1, 50):.3g} kPa"/>\n')
    return text, duration + 0.2


def run(sutura, scene, columns, limit):
    """Exit code (None: cut off), and where the run got to its end: the columns' values in the last line, the largest strain, and whether a
    note doubts that."""
    with tempfile.TemporaryDirectory() as out:
        path = pathlib.Path(out) / "scene.xml"
        path.write_text(scene)
        try:
            done = subprocess.run([sutura, "run", path, "--output", out + "/out"], capture_output=True, text=True, timeout=limit)
        except subprocess.TimeoutExpired:
            return None, None
        if done.returncode not in (0, 5):
            return done.returncode, None
        with open(next(pathlib.Path(out, "out").glob("*.csv"))) as file:
            rows = list(csv.DictReader(file))
        key = {c: [k for k in rows[0] if k.startswith(c.lstrip("/"))] for c in columns}
        last = [[float(rows[-1][k]) for k in key[c]] for c in columns]
        strain = max(float(row[key[columns[1]][0]]) for row in rows)
        return done.returncode, (last, strain, "with another step it may be slack" in done.stdout)


def compare(sutura, seed, limit):
    r = random.Random(seed)
    needle = seed % 5 >= 3
    dt = round(between(r, 1, 50), 3)
    text, duration = needle_scene(r) if needle else thread_scene(r)
    steps = max(2, math.ceil(1e3 * duration / dt))
    columns = ["/suture.end_position", "/suture.largest_strain"] + (["/puncture.punctures"] if needle else [])
    results = []
    for part in (1, 8):
        scene = HEAD.format(dt=dt / part, duration=steps * dt / 1e3) + text + f'  <CsvProbe columns="{" ".join(columns)}"/>\n</sutura>\n'
        results.append(run(sutura, scene, columns, limit))
    (code, found), (fine_code, fine) = results
    line, silent = f"{seed} {'needle' if needle else 'thread'} {dt:.3g} ms: exit {code}, at dt/8 {fine_code}", False
    if found and fine:
        line += f"; end apart by {1e3 * math.dist(found[0][0], fine[0][0]):.3g} mm; strain {found[1]:.2g}, {fine[1]:.2g}"
        line += ", doubted" if found[2] else ""
        silent = found[1] > 5 * fine[1] and found[1] > 2e-4 and not found[2]
        if needle:
            line += f"; punctures {found[0][2][0]:.0f}, {fine[0][2][0]:.0f}"
            silent = silent or found[0][2] != fine[0][2]
        silent = silent or not all(map(math.isfinite, sum(found[0], [])))
    else:
        line += "; NOT COMPARED"
    silent = silent and code == 0
    return code, silent, line + ("; SILENT" if silent else "")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("sutura")
    p.add_argument("--seeds", default="1-100")
    p.add_argument("--jobs", type=int, default=2)
    p.add_argument("--limit", type=float, default=120, help="seconds for one run")
    a = p.parse_args()
    first, last = (int(x) for x in a.seeds.split("-"))
    codes, silent = {}, 0
    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        for code, quiet, line in pool.map(lambda s: compare(a.sutura, s, a.limit), range(first, last + 1)):
            codes[code] = codes.get(code, 0) + 1
            silent += quiet
            print(line, flush=True)
    print(f"exit codes: {codes}; wrong without a word: {silent}")


main()
