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

APART = 3.1                     # half of the distance of the two mouths of the channel
LONG, TAIL = 51.2, 16.8         # from the mouths to the hand, and to where the tail is held
HAND = (19.97, -24.39, 40.88)   # where the hand takes the strand
DRAWN_IN = (-6.6, 15.2, 4.0)    # where the tail is held when the thread has been drawn through
LAID = (12.1, 0.5, 5.2)         # where it is held for the first throw,
TAKEN = (10.0, 0.45, 4.55)      # and where the tip of the jaws is that take it

HELD_2 = (13.5, 0.0, 3.9)       # where an assistant takes the tail after the first throw
RADIUS_2 = 12.4                 # of the way on which it is laid over: as far as it reaches
LONG_2, TAIL_2 = 48.5, 12.3     # from the first throw to the hand, and to where the jaws take the tail
TAKEN_2 = (9.1, 0.6, 4.15)      # where they do, from the place of the second throw

HELD_3 = (-11.6, 0.0, 1.2)      # likewise for the third throw
RADIUS_3 = 10.5
LONG_3, TAIL_3 = 44.2, 10.4
TAKEN_3 = (7.3, 0.6, 3.05)

TILT = 18                       # degrees: the jaws rise with the tail
HINGE = 15.0                    # of the jaws, behind their tip
OPEN, CLOSED = 1.75, 0.53       # from the middle of the jaws to that of a blade, at the tip
CLOSING = 0.08                  # s
JAWS = dict(tilt=TILT, park=80, wind=(-3, -21, 15), behind=8.0, bite=3.0, jaw=1.55, closed=1.25)


def swing(start, end, middle, count):
    """Points on the way round a middle, as far from it as the ends are in turn."""
    a, b = plus(start, middle, -1), plus(end, middle, -1)
    r, q = math.hypot(*a), math.hypot(*b)
    angle = math.acos(sum(x * y for x, y in zip(a, b)) / (r * q))
    for i in range(1, count):
        u = i / count
        way = [(math.sin((1 - u) * angle) * x / r + math.sin(u * angle) * y / q) / math.sin(angle) for x, y in zip(a, b)]
        yield u, plus(middle, way, (1 - u) * r + u * q)


def turns(tilt, opening):
    """Rotation vector (degrees) that turns by `opening` about z and then by `tilt` about y."""
    a, b = math.radians(opening) / 2, math.radians(tilt) / 2
    w, x, y, z = (math.cos(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a) * math.sin(b), math.sin(a) * math.cos(b))
    length = math.hypot(x, y, z)
    angle = math.degrees(2 * math.atan2(length, w))
    return tuple(angle * k / length for k in (x, y, z))


def blades(name, throws):
    """The way of the jaws, and those of their two blades, which turn about a hinge and close on the tail when the tip is there.
    Of throws that these jaws tie, each with what they do after it."""
    middle, front, back = [], [], []
    angle = math.degrees(math.asin((OPEN - CLOSED) / HINGE))
    for throw, more in throws:
        tilt = -TILT * throw.side
        keys = [(*key[:4], *turns(tilt, 0), key[4]) for key in throw.jaws + more]
        middle += keys
        closed = throw.touch + CLOSING
        for way, side in ((front, -1), (back, 1)):
            as_open, as_closed = turns(tilt, -side * throw.side * angle), turns(tilt, 0)
            for t, x, y, z, *_, what in keys:
                if t <= throw.touch:
                    way.append((t, x, y + side * OPEN, z, *as_open, what))
                if t == throw.touch:
                    way.append((closed, x, y + side * CLOSED, z, *as_closed, "the blades close"))
                if t > closed:
                    way.append((t, x, y + side * CLOSED, z, *as_closed, what))
    for part, keys in (("", middle), ("_front", front), ("_back", back)):
        table(HERE / f"{name}{part}.csv", keys)


def laid_over(start, side, held, radius, until):
    """The way of the tail from this side to the other, round the throws that are tied, where it is held until jaws have it."""
    keys = [(start - 0.05, *held, "the tail is held"), (start, *held, "the tail is held")]
    for i in range(1, 6):
        a = math.radians(15 + 143 * i / 5)
        at = (side * (0.2 + radius * math.cos(a)), 0.12 * i, 0.5 + radius * math.sin(a))
        keys.append((start + 0.2 * i, *at, "the tail is laid over"))
    return keys + [(until, *at, "the jaws take it")]


def round_the_knot(before, after, middle):
    """The way of the hand from the end of a throw to the beginning of the next."""
    (t0, *begin, _), (t1, *end, _) = before.hand[-1], after.hand[0]
    return [(t0 + u * (t1 - t0), *at, "the strand is drawn to the front") for u, at in swing(begin, end, middle, 5)]


if __name__ == "__main__":
    one = Throw(place=(0, 0, 0), apart=APART, turns=2, long=LONG, tail=TAIL - APART, give=0.5, pull=5.0, used=5.0,
                took=2.0, end_of_tail=TAKEN, slide=[1.6 - 0.13 * i for i in range(11)], start=5.4, **JAWS)
    two = Throw(place=(0, 0, 0.4), apart=0.3, side=-1, long=LONG_2, tail=TAIL_2, beside=0.1, give=0.5, pull=1.0,
                used=6.3, took=2.5, end_of_tail=TAKEN_2, slide=[1.7 - 0.08 * i for i in range(18)], draw=2.0,
                start=one.end + 0.3, **JAWS)
    three = Throw(place=(0, 0, 0.8), apart=0.3, side=1, long=LONG_3, tail=TAIL_3, beside=0.1, give=0.5, slack=1.5, pull=3.0,
                  used=6.3, took=2.5, end_of_tail=TAKEN_3, slide=[1.7 - 0.08 * i for i in range(18)], draw=2.0,
                  start=two.end + 0.3, **JAWS)
    let_go, let_go_2, cut = one.end + 0.85, two.end + 0.85, three.end + 0.55

    taken = [(t, *HAND, "the hand takes the strand") for t in (5.2, 5.35)]
    x, y, z = three.hand[-1][1:4]
    eased = (x + 1.2, y, z)
    leave = [(three.end + 0.2, x, y, z, "the hand gives way"), (three.end + 0.45, *eased, "the hand gives way"),
             (cut, *eased, "the ends are cut, and all go away"), (cut + 0.4, -70, 0, 20, "the ends are cut, and all go away")]
    table(HERE / "interrupted_hand.csv", taken + one.hand + round_the_knot(one, two, (0, 0, 0.5)) + two.hand +
          round_the_knot(two, three, (0, 0, 0.9)) + three.hand + leave)

    blades("interrupted_jaws", [(one, [(let_go + 0.02, *one.jaws[-1][1:4], "the jaws let go"),
                                       (let_go + 0.3, 45, 0, 10, "the jaws go away")]),
                                (three, [(cut, *three.jaws[-1][1:4], "the ends are cut, and all go away"),
                                         (cut + 0.4, 45, 0, 15, "the ends are cut, and all go away")])])
    blades("interrupted_other_jaws", [(two, [(let_go_2 + 0.02, *two.jaws[-1][1:4], "the jaws let go"),
                                             (let_go_2 + 0.3, -45, 0, 10, "the jaws go away")])])
    table(HERE / "interrupted_assistant.csv", laid_over(let_go, 1, HELD_2, RADIUS_2, two.touch + 0.1) +
          laid_over(let_go_2, -1, HELD_3, RADIUS_3, three.touch + 0.1))
    table(HERE / "interrupted_tail.csv",
          [(0.3, -71.45, 23.04, 28.06, "the tail follows"), (1.6, -60, 17, 13, "the tail follows"),
           (3.0, -48, 15, 10, "the tail follows"), (5.0, *DRAWN_IN, "the tail is drawn in"), (5.4, -4, 6, 14.5, "and laid over"),
           (5.8, 5, 3, 14, "and laid over"), (6.1, *LAID, "and laid over")])
    for name, throw in (("first", one), ("second", two), ("third", three)):
        print(f"{name} throw: the tip is there at {throw.touch:.4g} s, end {throw.end:.4g} s")
