#!/usr/bin/python3
"""Key frames of the hands that tie the stitch of interrupted.xml, as tables that Track reads. Run it to write them anew.

Lengths are in mm, times in s. What a run has to say first (where the thread comes up, how much of it) stands at the top.
"""
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "knots"))
from throws import Throw, plus, table  # noqa: E402

APART = 3.1                    # half of the distance of the two mouths of the channel
LONG, TAIL = 51.2, 16.8        # from the mouths to the hand and to the hold of the tail
HAND = (19.97, -24.39, 40.88)     # where the hand takes the strand
END = (12.1, 0.5, 5.2)         # where the tail is held for the first throw
TAKEN = (10.7, 0.5, 4.8)        # where the jaws take it
TAIL_END = (-6.6, 15.2, 4.0)     # where the tail is when the thread has been drawn through

HELD_2 = (13.5, 0.0, 3.9)      # where an assistant takes the tail after the first throw
RADIUS = 12.4
LONG_2, TAIL_2 = 48.5, 12.3    # from the first throw to the hand and to the end of the tail
TAKEN_2 = (9.8, 0.6, 4.4)      # where the jaws take it, from the place of the second throw

OPEN, CLOSED = 1.1, 0.62       # from the middle of the jaws to the axis of a blade


FINE = tuple(1.4 - 0.06 * i for i in range(19))


def swing(start, end, middle, count):
    """Points on the way round a middle, as far from it as the ends are in turn."""
    a, b = plus(start, middle, -1), plus(end, middle, -1)
    r, q = math.hypot(*a), math.hypot(*b)
    angle = math.acos(sum(x * y for x, y in zip(a, b)) / (r * q))
    for i in range(1, count):
        u = i / count
        way = [(math.sin((1 - u) * angle) * x / r + math.sin(u * angle) * y / q) / math.sin(angle) for x, y in zip(a, b)]
        yield u, plus(middle, way, (1 - u) * r + u * q)


def blades(name, throw, more):
    """The way of the jaws, and those of their two blades, which close on the tail when the tip is there."""
    table(HERE / f"{name}.csv", throw.jaws + more)
    for blade, side in (("front", -1), ("back", 1)):
        keys = []
        for t, x, y, z, what in throw.jaws + more:
            apart = OPEN if t <= throw.touch else CLOSED
            keys.append((t if t <= throw.touch else max(t, throw.touch + 0.08), x, y + side * apart, z, what))
            if t == throw.touch:
                keys.append((t + 0.08, x, y + side * CLOSED, z, "the blades close"))
        table(HERE / f"{name}_{blade}.csv", keys)


if __name__ == "__main__":
    one = Throw(place=(0, 0, 0), apart=APART, turns=2, slide=(1.2, 0.9, 0.7, 0.5, 0.3), give=0.5, long=LONG, tail=TAIL - APART, end_of_tail=TAKEN, bite=2.0, jaw=1.25, pull=5.0, used=5.0, took=1.2, start=5.4)
    two = Throw(place=(0, 0, 0.4), apart=0.3, side=-1, long=LONG_2, tail=TAIL_2, beside=0.1, pull=1.0, used=6.3, took=1.8,
                end_of_tail=TAKEN_2, bite=2.0, jaw=1.2, give=0.5, slide=FINE, draw=2.0, start=one.end + 0.3)
    (t0, *from_here, _), (t1, *to, _) = one.hand[-1], two.hand[0]
    between = [(t0 + u * (t1 - t0), *p, "the strand is drawn to the front") for u, p in swing(from_here, to, (0, 0, 0.5), 5)]
    hand = [(5.2, *HAND, "the hand takes the strand"), (5.35, *HAND, "the hand takes the strand")] + one.hand
    let_go = one.end + 0.85
    away = [(let_go + 0.02, *one.jaws[-1][1:4], "the jaws let go"), (let_go + 0.3, 45, 0, 10, "the jaws go away")]
    gone = two.end + 0.55
    off = [(gone, *two.jaws[-1][1:4], "the ends are cut, and all go away"), (gone + 0.4, -45, 0, 15, "the ends are cut, and all go away")]
    x, y, z = two.hand[-1][1:4]
    leave = [(two.end + 0.2, x, y, z, "the hand gives way"), (two.end + 0.45, x - 1.2, y, z, "the hand gives way"), (gone, x - 1.2, y, z, "the ends are cut, and all go away"), (gone + 0.4, 70, 0, 20, "the ends are cut, and all go away")]
    help = [(let_go - 0.05, *HELD_2, "the tail is held"), (let_go, *HELD_2, "the tail is held")]
    for i in range(1, 6):
        a = math.radians(15 + 143 * i / 5)
        help.append((let_go + 0.2 * i, 0.2 + RADIUS * math.cos(a), 0.12 * i, 0.5 + RADIUS * math.sin(a), "the tail is laid over"))
    tail = [(0.3, -71.45, 23.04, 28.06, "the tail follows"), (1.6, -60, 17, 13, "the tail follows"),
            (3.0, -48, 15, 10, "the tail follows"), (5.0, *TAIL_END, "the tail is drawn in"), (5.4, -4, 6, 14.5, "and laid over"), (5.8, 5, 3, 14, "and laid over"), (6.1, *END, "and laid over")]
    table(HERE / "interrupted_hand.csv", hand + between + two.hand + leave)
    blades("interrupted_jaws", one, away)
    blades("interrupted_other_jaws", two, off)
    table(HERE / "interrupted_assistant.csv", help)
    table(HERE / "interrupted_tail.csv", tail)
    print(f"let go {let_go:.4g} s, grasp {two.grasp:.4g} s, end {two.end:.4g} s")
    print(f"grasp {one.grasp:.4g}, let go {one.let_go:.4g} s, end {one.end:.4g} s")
