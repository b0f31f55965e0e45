#!/usr/bin/python3
"""Key frames of an instrument tie, as tables that Track reads. Run it to write the tables of this folder anew.

A throw is tied as surgeons do it. The thread comes up at two points: a long strand, whose end a hand holds, and a tail
that points away from the place, to the side of the long strand. Closed jaws come from the side of the long strand. The hand winds the strand round them, once or
twice; the jaws go to the tail, take its end and draw it back through the loop, which slides off. Then both are drawn
apart, each to the other side, and the throw is tight.

The strand is wound from the base of the jaws towards their tip. The other way round it would cross itself instead, and
what is drawn tight is no throw. Lengths are in mm, times in s.
"""
import math
import pathlib

HERE = pathlib.Path(__file__).resolve().parent


def plus(a, b, factor=1.0):
    return tuple(x + factor * y for x, y in zip(a, b))


def unit(a):
    return tuple(x / math.hypot(*a) for x in a)


class Throw:
    """The keys of one throw: `hand` and `jaws` (the way of their tip) are lists of (time, x, y, z, what is done).

    place   middle between the two points where the thread comes up
    apart   half of their distance
    side    1: the long strand comes up on the side of +x; -1: of -x
    front   1: the hand winds before the place, on the side of -y; -1: behind it
    turns   round the jaws: 1, or 2 for a surgeon's throw
    long    from where the strand comes up to the hand
    tail    length of the tail, which lies on what the thread goes round, and stands out from it to the long strand's side
    lean    elevation of the tail in degrees
    beside  by how much the long strand lies before the tail
    jaw     radius of the jaws and the thread together, while the strand is wound; of a bar of the same girth
    closed  likewise, when they have closed; as before where it is left out
    behind  by how much the strand is wound behind the tip
    wind    where it is wound, in the throw's own axes: the hand goes round there, and must not get into anything
    park    how far away the jaws wait until the strand is in front
    tilt    by how many degrees the jaws rise from their tip on
    give    by how much the hand gives way while it draws the strand taut
    slack   by how much less, while the jaws take the tail and the loop slides along it
    pull    likewise, when the throw is tightened
    used    what the throw and what is in it take of the long strand; 1.6 * apart where it is left out
    took    likewise of the tail
    height  of the hand and the jaws above the place, when they have been drawn apart; 1.1 * apart where it is left out
    end_of_tail  in the throw's own axes, where the tail does not lie as said, but is held somewhere
    bite    by how much the jaws go over the end of the tail, where they are two blades with a gap; then `end_of_tail` is
            where their tip comes to
    slide   where the loop is when there is a key, as a share of the tail, while it slides along it: more keys keep it taut
    draw    by how much the jaws draw the tail taut meanwhile
    start   0: the thread lies as it is laid out; later: the hand and the tail come from wherever they are

    The jaws point to the other side of the long strand; `side` -1 turns them round in the scene. A second throw makes a square knot with the other side and the same front, a granny with both changed.
    """

    def __init__(self, place, apart, side=1, front=1, turns=1, long=50.0, tail=14.0, lean=30.0, beside=0.6, jaw=1.1,
                 give=1.0, slack=0.0, pull=10.0, took=2.4, end_of_tail=None, bite=0.0, slide=(0.7, 0.3), draw=0.0,
                 used=None, height=None, closed=None, behind=5.0, tilt=0.0,
                 park=48.0, wind=(-3, -15, 10), start=0.0):
        self.place, self.apart, self.side, self.front = place, apart, side, front
        self.turns, self.long, self.tail, self.jaw = turns, long, tail, jaw
        self.bite, self.slide, self.draw = bite, slide, draw
        self.closed, self.behind = jaw if closed is None else closed, behind
        self.backwards = (math.cos(math.radians(tilt)), 0, math.sin(math.radians(tilt)))  # along the jaws, from their tip
        self.time, self.hand, self.jaws = start, [], []
        a = math.radians(lean)
        aslant = beside / (apart * (1.5 * math.pi - a))  # of the thread that goes round: a helix
        self.foot = (-apart * math.sin(a), beside / 2, apart * math.cos(a))
        self.end_of_tail = plus(self.foot, unit((math.cos(a), aslant, math.sin(a))), tail)
        if end_of_tail is not None:
            self.end_of_tail = end_of_tail
        self.from_here = (apart, -beside / 2, 0)
        self.as_it_lies = plus(self.from_here, unit((0, -aslant, 1)), long)
        self.wind(give, wind, park)
        self.take(give - slack)
        self.tighten(pull, took, 1.6 * apart if used is None else used, 1.1 * apart if height is None else height)

    def key(self, seconds, hand, tip, what):
        """So many seconds later the hand and the tip are there, in the throw's own axes: x from the tail to the long
        strand, -y to the front, z up. None: on the way to the next key."""
        self.time += seconds
        for keys, at in ((self.hand, hand), (self.jaws, tip)):
            if at is not None:
                x, y, z = self.side * at[0], self.front * at[1], at[2]
                keys.append((self.time, *plus(self.place, (x, y, z)), what))

    def taut(self, loop, wound, towards, give):
        """Where the hand is when the strand comes up, is wound by so many degrees at `loop`, and goes on to it."""
        used = math.dist(self.from_here, loop) + self.jaw * math.radians(wound)
        return plus(loop, unit(towards), self.long - used + give)

    def wind(self, give, loop, park):
        """In front, where nothing is in the way. Angles of the strand that goes to the hand: 0 down, 90 to the front,
        180 up. It comes from behind and below, goes on under the jaws, and at `first` it begins to bend."""
        first, last = 110, 450 + 360 * (self.turns - 1)
        tip = plus(loop, self.backwards, -self.behind)

        def round_the_jaws(angle):
            a = math.radians(angle)
            return self.taut(loop, angle - first, (-0.25, -math.sin(a), -math.cos(a)), give)

        drop = 3 + loop[2] - tip[2]
        below = unit(plus(plus(loop, (0, 0, -drop)), self.from_here, -1))
        ready = plus(self.from_here, below, self.long + give)
        away = plus(tip, (park, 0, 0))
        self.key(0, self.as_it_lies if self.time == 0 else None, away, "as it lies")
        self.key(0.4, ready, away, "the strand is drawn to the front")
        self.key(0.3, ready, None, "the jaws come over it")
        self.key(0.2, round_the_jaws(first), tip, "the strand lies on the jaws")
        steps = round((last - first) / 20)
        for i in range(1, steps + 1):
            self.key(1.2 / steps, round_the_jaws(first + 20 * i), None, "the strand is wound")
        self.key(0, None, tip, "the strand is wound")
        self.wound = 20 * steps

    def take(self, give):
        """The jaws meet the end of the tail, and the hand pulls along them until they have it, so that the loop stays.
        Then the hand goes to the other side, and the loop slides over the tip and along the tail."""
        end = self.end_of_tail

        def both(seconds, tip, towards, what):
            loop = plus(tip, self.backwards, self.behind)
            self.key(seconds, self.taut(loop, self.wound, towards, give), tip, what)

        before = plus(end, self.backwards, 2 + self.bite)
        both(0.3, plus(before, (0, -8, 0)), (0.6, -1, 0.1), "jaws and loop go to the tail")
        both(0.3, before, (0.7, -1, 0.1), "jaws and loop go to the tail")
        both(0.15, end, (0.7, -1, 0.1), "the tip touches the end of the tail")
        self.touch, self.grasp = self.time, self.time + 0.05
        self.jaw = self.closed
        both(0.1, end, (0.7, -1, 0.1), "the jaws take it")
        for part in self.slide:
            u = min(1, max(0, (0.7 - part) / 0.4))
            towards = tuple((1 - u) * a + u * b for a, b in zip((-0.3, -1, 0), (-1, -0.8, -0.1)))
            loop = plus(self.foot, plus(end, self.foot, -1), part)
            tip = plus(end, (min(1, max(0, 2 * (1 - part))) * self.draw, 0, 0))
            self.key(0.8 / len(self.slide), self.taut(loop, self.wound, towards, give), tip, "the loop slides along the tail")
        self.let_go = self.time + 0.2

    def tighten(self, pull, took, used, height):
        """The knot lies a thread's radius or two above the place."""
        hand, tip = used - self.long, self.tail - took
        self.key(0.4, (hand + 2, 0, 2 * height), (tip - 1.2, 0, 2 * height), "both are drawn apart")
        self.key(0.4, (hand, 0, height), (tip - 1.2, 0, height), "both are drawn apart")
        self.key(0.5, (hand - pull, 0, height), (tip, 0, height), "the throw is tightened")
        self.end = self.time


def table(name, keys):
    """Of keys (time, x, y, z, what is done), or with a rotation vector in degrees before that."""
    header = ["t [s], x [mm], y [mm], z [mm]", ", rx [deg], ry [deg], rz [deg]" if len(keys[0]) > 5 else ""]
    lines, said = ["".join(header)], None
    for time, *numbers, what in keys:
        if what != said:
            lines.append(f"# {what}")
        said = what
        lines.append(", ".join([f"{time:.4g}"] + [f"{x:.2f}" for x in numbers]))
    (HERE / name).write_text("\n".join(lines) + "\n")


def square_knot():
    """Two throws. Between them the first jaws let go and an assistant's hand lays the tail over to the other side."""
    one = Throw(place=(0, 0, 0), apart=1.61)
    two = Throw(place=(0, 0, 1.9), apart=0.3, side=-1, long=47.0, tail=11.2, beside=0.1, pull=2.0, took=3.4,
                end_of_tail=(8.85, 0.59, 4.90), start=5.4)
    held = plus(one.jaws[-1][1:4], (-2.2, 0, 0))
    x, y, z = two.end_of_tail
    over = plus((-x, y, z + 1.9), (0.7, 0.2, 0.1))
    away = [(6.2, *one.jaws[-1][1:4], "the jaws let go"), (6.5, 45, 0, 10, "the jaws go away")]
    help = [(6.25, *held, "the tail is held"), (6.45, *plus(held, (-2, 0, 5)), "the tail is laid over"),
            (6.65, 0.5, 0, 11, "the tail is laid over"), (6.85, *over, "the tail is laid over")]
    table("square_hand.csv", one.hand + two.hand)
    table("square_jaws.csv", one.jaws + away)
    table("square_other_jaws.csv", two.jaws)
    table("square_assistant.csv", help)
    print(f"square knot: grasp {one.grasp:.4g} and {two.grasp:.4g} s, end {two.end:.4g} s")


if __name__ == "__main__":
    throw = Throw(place=(0, 0, 0), apart=1.61)
    table("throw_hand.csv", throw.hand)
    table("throw_jaws.csv", throw.jaws)
    print(f"throw: grasp {throw.grasp:.4g} s, let go {throw.let_go:.4g} s, end {throw.end:.4g} s")
    square_knot()
