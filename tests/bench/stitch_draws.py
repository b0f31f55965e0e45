#!/usr/bin/python3
"""stitch_draws.py SUTURA [--scene interrupted] [--draws 1-20] [--jobs N] [--dt MS] [--until S] [--limit S] [--out DIR]: ties the stitch of
scenes/suture/interrupted.xml, or the running suture of running_tied.xml, with ways of hands and jaws that have been moved at random, and
counts how many are tied.

Every key frame of every instrument is moved by up to 0.5 mm along each axis and turned by up to 3 degrees, by itself; besides, all of
them are turned by up to 3 degrees about the place of the stitch. The two blades of a pair of jaws move as one. Draw 0 moves nothing.
"""
import argparse
import bisect
import concurrent.futures
import csv
import math
import pathlib
import random
import shutil
import subprocess
import tempfile

SUTURE = pathlib.Path(__file__).resolve().parents[2] / "scenes" / "suture"
BLADES = ["_front", "_back"]
HANDS = {"hand": [], "tail": [], "assistant": [], "jaws": BLADES, "other_jaws": BLADES}


class Task:
    """A scene: its instruments, until when it runs (s), when which jaws should have the tail, how many throws are tied, which gaps they
    close, and when each is tight."""

    def __init__(self, name, instruments, until, catches, gaps, tight):
        self.name, self.instruments, self.until, self.catches = name, instruments, until, catches
        self.throws, self.gaps, self.tight = len(catches), gaps, tight


TASKS = {task.name: task for task in (
    Task("interrupted", HANDS, 22.5, [("tips", 8.6), ("other_tips", 14), ("tips", 19.3)], ["gap"], (10.4, 15.8, 21.2)),
    Task("running_tied", HANDS | {"over": []}, 38.35, [("tips", 29.6), ("other_tips", 35)], ["gap_1", "gap_2", "gap_3"], (31.4, 36.8)))}
MOVE, TURN = 0.5, math.radians(3)  # mm


def times(q, p):
    """Product of two quaternions (w, x, y, z): first p, then q."""
    a, b, c, d = q
    w, x, y, z = p
    return (a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y, a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w)


def quaternion(turn):
    angle = math.hypot(*turn)
    s = math.sin(angle / 2) / angle if angle else 0.5
    return (math.cos(angle / 2), *(s * x for x in turn))


def turn_of(q):
    length = math.hypot(*q[1:])
    angle = 2 * math.atan2(length, q[0])
    return [angle * x / length if length else 0.0 for x in q[1:]]


def turned(turn, at):
    q = quaternion(turn)
    return times(times(q, (0, *at)), (q[0], -q[1], -q[2], -q[3]))[1:]


def ball(draw, size):
    """A vector whose direction and length are drawn."""
    while True:
        v = [draw.uniform(-1, 1) for _ in range(3)]
        if 0 < math.hypot(*v) <= 1:
            return [size * x for x in v]


def read(path):
    rows = [line for line in csv.reader(open(path)) if not line[0].startswith("#")]
    return rows[0], [[float(x) for x in row] for row in rows[1:]]


def moved_ways(task, draw, folder):
    """Writes all tables anew into the folder."""
    common = ball(draw, TURN)
    for name, parts in task.instruments.items():
        head, keys = read(SUTURE / f"{task.name}_{name}.csv")
        at = [key[0] for key in keys]
        moves = [([draw.uniform(-MOVE, MOVE) for _ in range(3)], ball(draw, TURN)) for _ in keys]

        def between(way, t):
            i = bisect.bisect_right(at, t)
            if i in (0, len(at)):
                return way[min(i, len(at) - 1)]
            u = (t - at[i - 1]) / (at[i] - at[i - 1])
            return [[(1 - u) * x + u * y for x, y in zip(p, q)] for p, q in zip(way[i - 1], way[i])]

        middles = [[key[1:4]] for key in keys]
        for part in ["", *parts]:
            with open(folder / f"{task.name}_{name}{part}.csv", "w") as out:
                print(", ".join(x.strip() for x in head), file=out)
                for key in read(SUTURE / f"{task.name}_{name}{part}.csv")[1]:
                    move, turn = between(moves, key[0])
                    middle, = between(middles, key[0])
                    arm = turned(turn, [x - m for x, m in zip(key[1:4], middle)])
                    place = turned(common, [m + x + d for m, x, d in zip(middle, arm, move)])
                    row = [key[0], *place]
                    if len(key) > 4:
                        q = times(quaternion(turn), quaternion([math.radians(x) for x in key[4:]]))
                        row += [math.degrees(x) for x in turn_of(times(quaternion(common), q))]
                    print(", ".join(f"{x:.6g}" for x in row), file=out)


def run(sutura, number, options):
    task = TASKS[options.scene]
    folder = pathlib.Path(options.out) / f"{task.name}_{number}"
    checkpoint = folder / "out" / "checkpoint.sutura"
    command = [sutura, "run", folder / f"{task.name}.xml", "--output", folder / "out", "--duration", f"{options.until or task.until} s",
               "--set", f".dt={options.dt} ms", "--set", "/vtu_recorder.interval=100 s", "--checkpoint-every", "1 s"]
    if checkpoint.exists():
        command += ["--resume", checkpoint]
    else:
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        for path in SUTURE.glob(f"{task.name}*"):
            shutil.copy(path, folder)
        if number:
            moved_ways(task, random.Random(number), folder)
    try:
        code = subprocess.run(command, capture_output=True, timeout=options.limit).returncode
    except subprocess.TimeoutExpired:
        code = -1
    with open(folder / "out" / "probe.csv") as probe:
        head, *rows = csv.reader(probe)
    if code != -1:
        shutil.rmtree(folder)
    rows = [row for row in rows if len(row) == len(head)]  # the last one may be in the making
    columns = {name.split(" ")[0]: column for name, column in zip(head, zip(*rows))}
    time = [float(x) for x in columns["time"]]

    def at(name, t):
        return float(columns[name][bisect.bisect_right(time, t) - 1]) if t <= time[-1] else math.nan

    # Have the jaws caught the tail for each throw, and how far apart are the lips when it is tight?
    caught = "".join("-" if math.isnan(n) else str(int(n > 0)) for n in (at(f"{jaws}.pieces", t) for jaws, t in task.catches))
    gaps = [max(at(f"{gap}.distance", t) for gap in task.gaps) for t in (*task.tight, time[-1])]
    ended = {name: float(columns[name][-1]) for name in ("time", "tight.throws", "tight.crossings", "suture.cuts", "puncture.punctures")}
    return {"draw": number, "code": code, "steps": len(rows), "missed": sum(float(x) == 0 for x in columns["solved"]),
            "passes": sum(map(float, columns["passes"])) / len(rows), "caught": caught, "gaps": gaps, **ended}


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sutura")
    parser.add_argument("--scene", choices=TASKS, default="interrupted")
    parser.add_argument("--draws", default="1-20")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--dt", type=float, default=4)
    parser.add_argument("--until", type=float, default=None)
    parser.add_argument("--limit", type=float, default=1e6,
                        help="time that a run may take (s); its exit code is then -1, and the same call with the same --out goes on with it")
    parser.add_argument("--out", default=None)
    options = parser.parse_args()
    options.out = options.out or tempfile.mkdtemp()
    first, _, last = options.draws.partition("-")
    numbers = range(int(first), int(last or first) + 1)
    print("draw  exit  ended at  steps  missed  passes  punctures  caught  cuts  throws  crossings  gap after each throw (mm), and at the end")
    tied = 0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for r in pool.map(lambda number: run(options.sutura, number, options), numbers):
            is_tied = r["code"] in (0, 5) and r["tight.throws"] == TASKS[options.scene].throws and r["gaps"][-1] < 0.5e-3
            tied += is_tied
            print(f"{r['draw']:4}  {r['code']:4}  {r['time']:6.2f} s  {r['steps']:5}  {r['missed']:6}  {r['passes']:6.2f}"
                  f"  {r['puncture.punctures']:9.0f}  {r['caught']:>6}  {r['suture.cuts']:4.0f}  {r['tight.throws']:6.0f}  {r['tight.crossings']:9.0f}"
                  f"  {' '.join(f'{1e3 * x:.3f}' for x in r['gaps'])}  {'tied' if is_tied else ''}", flush=True)
    print(f"{tied} of {len(numbers)} end with all their throws and a gap below 0.5 mm")
