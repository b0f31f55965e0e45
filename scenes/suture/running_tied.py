#!/usr/bin/python3
"""Writes running_tied.xml and the ways of its hands: a running suture of five bites, sewn by its needle, whose ends are tied to each
other over the middle of the wound. Lengths are in mm, times in s.

The wound lies along x. A bite goes from y = BITE, where the needle turns in, to y = -BITE; the next is APART further along x. After
each bite the needle draws the thread through until it is taut, and an assistant's hand takes the strand in its middle and holds it
aside, so that the next bite does not catch it.
"""
import math
import pathlib
import sys

from interrupted import blades, laid_over, round_the_knot

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "knots"))
from throws import Throw, plus, table, unit  # noqa: E402

BITES, APART = 5, 3.0
RADIUS = 13.0 / math.pi               # of the needle, a half circle of 13 mm
HIGH, LOW = 9.0, 2.0                  # of its centre above the skin: on its way, and in a bite
BITE = math.sqrt(RADIUS**2 - LOW**2)  # from the middle of the wound to a mouth
USED = 15.0                           # of the thread, from bite to bite
PULL = 5.0                            # how far the hand at the needle, of 20 N/m, goes on when the thread is taut
OUT = unit((0.45, -0.65, 0.6))        # where it draws the thread to
ASIDE = unit((-0.7, -0.35, 0.65))     # where the assistant holds the strand
BEHIND = unit((-0.3, 0.9, 0.3))       # where the thread lies at the start,
LAID_OUT = (-52.56, 134.33, 51.46)    # and its end

LONG, TAIL = 55.1, 20.7               # from the last mouth to the hand, from the first to where the tail is held
BEYOND = 9.2                          # of the thread, from the hand to the needle
THREAD = BEYOND + LONG + USED * (BITES - 1) + 8.8 + TAIL + 0.5  # with what lies in the first channel, and behind the hold of the tail
LAID = (13.1, 0.5, 5.2)               # where the tail is held for the first throw,
TAKEN = (11.0, 0.45, 4.55)            # and where the tip of the jaws is that take it

HELD_2 = (14.5, 0.0, 3.9)             # where an assistant takes the tail after the first throw
RADIUS_2 = 13.4                       # of the way on which it is laid over: as far as it reaches
LONG_2, TAIL_2 = 50.5, 13.3           # from the first throw to the hand, and to where the jaws take the tail
TAKEN_2 = (10.1, 0.6, 4.15)           # where they do, from the place of the second throw

JAWS = dict(tilt=18, park=80, behind=8.0, bite=3.0, jaw=1.55, closed=1.25)


def along(bite):
    return (bite - (BITES - 1) / 2) * APART


def mouth(bite, side):
    return (along(bite), side * BITE, 0)


HAND = plus(mouth(BITES - 1, -1), OUT, LONG - 0.5)  # where the hand takes the strand


class Sewing:
    """Key frames of the needle (time, x, y, z of its centre, angle by which it has turned), of the tail and of the assistant, and the
    times at which their hands close and open."""

    def __init__(self):
        self.needle, self.tail, self.aside = [(0.0, along(0), 0, HIGH, 0)], [], []
        self.holder, self.puller = ([0.0], []), ([], [])
        self.assistants = []  # (where on the thread, taken, let go), one for each bite but the last
        self.end = 0.3
        for bite in range(BITES):
            self.bite(bite)
            if bite + 1 < BITES:
                self.go_on(bite)

    def left(self, bite):
        """Length of the thread from this bite to the needle, when it is taut."""
        return BEYOND + LONG + USED * (BITES - 1 - bite)

    def drawn_out(self, bite):
        """Centre of the needle when it has drawn the thread through: its end leads, 75 degrees past the lowest point."""
        a = math.radians(75)
        end = (0, -RADIUS * math.sin(a), -RADIUS * math.cos(a))
        return plus(plus(mouth(bite, -1), OUT, self.left(bite) + PULL), end, -1)

    def bite(self, bite):
        """The holder turns the needle through both lips, the puller takes its tip, turns it out and draws the thread through."""
        start, turn, centre = self.end, 360 * bite, (along(bite), 0, LOW)
        pierced, turned_out = start + 1.3, start + 2.5
        self.end = turned_out + (2.4 if bite == 0 else 1.4)
        self.needle += [(start, *centre, turn), (pierced, *centre, turn + 161), (pierced + 0.2, *centre, turn + 161),
                        (turned_out, *centre, turn + 330), (self.end, *self.drawn_out(bite), turn + 330)]
        self.puller[0].append(pierced + 0.1)
        self.holder[1].append(pierced + 0.15)
        if bite == 0:  # a hand lets the end of the thread follow
            slack = 0.93
            self.tail.append((start, *LAID_OUT, "the tail follows"))
            for time, far in ((pierced, slack * THREAD), (turned_out, slack * (THREAD - 11)), (self.end, TAIL)):
                self.tail.append((time, *plus(mouth(0, 1), BEHIND, far), "the tail follows"))

    def go_on(self, bite):
        """The assistant takes the strand in its middle and holds it aside, until the needle has gone through the next bite; the needle
        comes back over the wound, and the holder takes it."""
        taut, over = self.end, self.end + 1.3
        left, drawn, following = self.left(bite), self.drawn_out(bite), along(bite + 1)
        self.needle += [(taut + 0.2, *drawn, 360 * bite + 330), (taut + 0.9, following, -8, HIGH + 14, 360 * (bite + 1)),
                        (over - 0.3, following, 0, HIGH, 360 * (bite + 1))]
        self.holder[0].append(over - 0.25)
        self.puller[1].append(over - 0.2)
        middle = plus(mouth(bite, -1), OUT, (left + PULL) / 2)
        aside = plus((along(bite + 0.5), 0, 0), ASIDE, 0.45 * left)
        self.assistants.append((13 + left / 2, taut, over + 2.4))
        self.aside += [(taut, *middle, "the assistant takes the strand"), (taut + 0.2, *middle, "the assistant takes the strand"),
                       (over, *aside, "and holds it aside"), (over + 2.45, *aside, "and holds it aside")]
        self.end = over


def gives_way(way, by, rest, seconds):
    """Keys of a hand or of jaws that rest where their way ends, with a throw drawn tight, and then go so far along x."""
    t, x, y, z = way[-1][:4]
    keys = [(t + rest, x, y, z, "the throw is tight"), (t + rest + seconds, x + by, y, z, "hand or jaws give way")]
    return keys if rest else keys[1:]


def words(numbers):
    return " ".join(f"{x + 0:.6g}" for x in numbers)


SCENE = """<?xml version="1.0"?>
<!-- A running suture, from the first bite to the cut ends (docs/wound.md). Two lips 1 mm apart; a 13 mm half-circle needle with {thread:.0f} mm
     of braided thread of 0.2 mm.
     0 to {sewn:.3g} s      five bites, 3 mm apart: the needle goes through both lips, is taken over at its tip, turned out, and draws its thread
                   through until it is taut; an assistant holds the strand aside while the next bite is sewn
     to {one.end:.4g} s    a hand takes the strand, the needle is cut off, and a throw of two turns ties the strand to the tail of the first bite
     to {two.end:.4g} s     an assistant lays the tail over, and a throw from the other side makes a surgeon's knot (2 = 1) over the wound
     {cut:.4g} s       the ends are cut, and all instruments go away
     running_tied.py writes this file. -->
<sutura version="1" dt="5 ms" gravity="0 0 -9.81" duration="{duration:.4g} s">
  <plugin name="thread"/> <plugin name="tissue"/> <plugin name="suturing"/> <plugin name="tools"/> <plugin name="contact"/> <plugin name="output"/>

  <node name="skin">
    <BlockMesh box="-12 -8.5 -6  12 8.5 0 mm" cells="24 17 6" holes="-8 -0.5 -4  8 0.5 0 mm"/>
    <AsyncPreconditioner lag="3"/>
    <Tissue name="tissue" young="30 kPa" poisson="0.4" density="1000" damping_stiffness="10 ms"/>
    <Attach box="-12 -8.5 -6  12 8.5 -6 mm"/>
    <TissueProbe name="left_1" point="-3 0.5 0 mm"/> <TissueProbe name="right_1" point="-3 -0.5 0 mm"/>
    <TissueProbe name="left_2" point="0 0.5 0 mm"/> <TissueProbe name="right_2" point="0 -0.5 0 mm"/>
    <TissueProbe name="left_3" point="3 0.5 0 mm"/> <TissueProbe name="right_3" point="3 -0.5 0 mm"/>
  </node>

  <SutureThread name="suture" needle="13 mm 1/2 circle" needle_centre="{centre} mm" tip_angle="-75 deg" plane_normal="-1 0 0"
                thread_young="2 GPa" thread_density="1100" thread_diameter="0.2 mm" bending_factor="0.015"
                damping_stiffness="0.1 ms" damping_mass="5 1/s" thread_length="{thread:.1f} mm" thread_beams="{beams}"
                sampling_angle="0.3 rad" shortest_beam="0.2 mm"
                thread_direction="{behind}" thread_bend_radius="3 mm"/>

  <Track name="needle" about="suture" easing="smooth"
         times="{times} s"
         turns="{turns} deg"
         positions="{positions} mm"/>
  <Grasper name="holder" track="needle" at="11.5 mm" grasp="{holder[0]} s" release="{holder[1]} s"/>
  <Grasper name="puller" track="needle" at="1 mm" stiffness="20 N/m" grasp="{puller[0]} s" release="{puller[1]} s"/>

  <Track name="aside" file="running_tied_assistant.csv"/>
{assistants}
  <Track name="tail_way" file="running_tied_tail.csv" easing="smooth"/>
  <Grasper name="tail" track="tail_way" at="{end:.1f} mm" stiffness="50 N/m" rotation_stiffness="0" closing="0.2 s"
           release="{tail_released:.4g} s"/>

  <Track name="hand_way" file="running_tied_hand.csv"/>
  <Grasper name="hand" track="hand_way" at="22.2 mm" stiffness="50 N/m" rotation_stiffness="0" closing="0.1 s" grasp="{taken:.4g} s"/>

  <Track name="jaws_way" file="running_tied_jaws.csv"/>
  <Track name="front_way" file="running_tied_jaws_front.csv"/>
  <Track name="back_way" file="running_tied_jaws_back.csv"/>
  <Tool name="front" shape="box" size="40 0.8 2 mm" rounding="0.4 mm" centre="20 0 0 mm" motion="front_way"/>
  <Tool name="back" shape="box" size="40 0.8 2 mm" rounding="0.4 mm" centre="20 0 0 mm" motion="back_way"/>
  <Forceps name="tips" body="suture" track="jaws_way" centre="2.1 0 0 mm" axis="0 1 0" size="4 2 2.6 mm" strength="2 N"
           grasp="{one.touch:.4g} s" closing="80 ms" release="{let_go:.4g} s"/>

  <Track name="over_way" file="running_tied_over.csv"/>
  <Grasper name="over" track="over_way" at="{end:.1f} mm" stiffness="50 N/m" rotation_stiffness="0" closing="0.2 s"
           grasp="{over_taken:.4g} s" release="{over_released:.4g} s"/>
  <Track name="other_jaws_way" file="running_tied_other_jaws.csv"/>
  <Track name="other_front_way" file="running_tied_other_jaws_front.csv"/>
  <Track name="other_back_way" file="running_tied_other_jaws_back.csv"/>
  <Tool name="other_front" shape="box" size="40 0.8 2 mm" rounding="0.4 mm" centre="-20 0 0 mm" motion="other_front_way"/>
  <Tool name="other_back" shape="box" size="40 0.8 2 mm" rounding="0.4 mm" centre="-20 0 0 mm" motion="other_back_way"/>
  <Forceps name="other_tips" body="suture" track="other_jaws_way" centre="-2.1 0 0 mm" axis="0 1 0" size="4 2 2.6 mm" strength="2 N"
           grasp="{two.touch:.4g} s" closing="80 ms"/>

  <Contact name="on_other_front" first="suture" tool="other_front" friction="0.2"/>
  <Contact name="on_other_back" first="suture" tool="other_back" friction="0.2"/>
  <Contact name="knot" first="suture" friction="0.4"/>
  <Knots name="tight" contact="knot"/>
  <Contact name="on_front" first="suture" tool="front" friction="0.2"/>
  <Contact name="on_back" first="suture" tool="back" friction="0.2"/>
  <Track name="still" times="0" positions="0 0 0"/>
  <Scissors name="needle_off" track="still" centre="{needle_off} mm" size="3 3 3 mm" times="{cut_off:.4g} s"/>
  <Scissors name="left_blades" track="still" centre="-8.5 0 1.5 mm" axis="0 1 0" size="0.6 3 6 mm" times="{cut:.4g} s"/>
  <Scissors name="right_blades" track="still" centre="8.5 0 1.5 mm" axis="0 1 0" size="0.6 3 6 mm" times="{cut:.4g} s"/>
  <Contact name="on_skin" first="suture" second="/skin/tissue" friction="0.3"/>
  <Puncture threshold="0.05 N" exit_threshold="0.03 N" friction="0.2"/>
  <Cutting threshold="0.02 N"/>
  <SuturePath name="path" spacing="1 mm"/>
  <PathFriction coefficient="0.2" pressure="30 kPa"/>
  <Distance name="gap_1" from="/skin/left_1" to="/skin/right_1"/>
  <Distance name="gap_2" from="/skin/left_2" to="/skin/right_2"/>
  <Distance name="gap_3" from="/skin/left_3" to="/skin/right_3"/>
  <VtuRecorder interval="50 ms"/>
  <CsvProbe report="true" columns="/gap_1.distance /gap_2.distance /gap_3.distance /puncture.punctures /puncture.overruns /path.inserted_length
                                   /path.state /path_friction.force /suture.cuts /suture.kinetic_energy /tight.throws /tight.crossings
                                   /holder.force /puller.force /tail.force /hand.force /tips.force /tips.pieces /over.force
                                   /other_tips.force /other_tips.pieces /knot.touches /on_skin.touches"/>
</sutura>
"""

if __name__ == "__main__":
    sewing = Sewing()
    start = sewing.end + 0.4
    to_middle = math.hypot(2 * APART, BITE)
    one = Throw(place=(0, 0, 0), apart=2 * APART, beside=2 * BITE, turns=2, long=LONG, tail=TAIL - to_middle, give=0.5, pull=6.5,
                used=to_middle + 1.9, took=1.0, height=3.4, end_of_tail=TAKEN, slide=[1.6 - 0.13 * i for i in range(11)],
                wind=(-3, -26, 18), start=start, **JAWS)
    two = Throw(place=(0, 0, 1.0), apart=0.3, side=-1, long=LONG_2, tail=TAIL_2, beside=0.1, give=0.5, pull=4.0,
                used=3.5, took=1.0, end_of_tail=TAKEN_2, slide=[1.7 - 0.08 * i for i in range(18)], draw=2.0,
                wind=(-3, -23, 16), start=one.end + 0.3, **JAWS)
    let_go, cut = one.end + 0.85, two.end + 0.55
    away = "the ends are cut, and all go away"

    taken = [(t, *HAND, "the hand takes the strand") for t in (sewing.end, start - 0.05)]
    one.hand += gives_way(one.hand, 3, 0, 0.2)  # drawn tight and swung round at the same time, two turns are hard to solve
    leave = gives_way(two.hand, -5, 0.15, 0.25)  # cut taut, the ends would spring back, and the knot might open
    leave += [(cut, *leave[-1][1:4], away), (cut + 0.4, 70, 0, 20, away)]
    table(HERE / "running_tied_hand.csv", taken + one.hand + round_the_knot(one, two, (-1.5, 0.5, 1)) + two.hand + leave)
    blades("running_tied_jaws", [(one, [(let_go + 0.02, *one.jaws[-1][1:4], "the jaws let go"),
                                        (let_go + 0.3, 45, 0, 10, "the jaws go away")])])
    leave = gives_way(two.jaws, 1, 0.15, 0.25)
    leave += [(cut, *leave[-1][1:4], away), (cut + 0.4, -45, 0, 15, away)]
    blades("running_tied_other_jaws", [(two, leave)])
    table(HERE / "running_tied_over.csv", laid_over(let_go, 1, HELD_2, RADIUS_2, two.touch + 0.1))
    table(HERE / "running_tied_tail.csv", sewing.tail + [
        (start, *sewing.tail[-1][1:4], "and is laid over"), (start + 0.4, -8, 9, 18.5, "and is laid over"),
        (start + 0.8, 3, 5, 17, "and is laid over"), (start + 1.1, *LAID, "and is laid over")])
    table(HERE / "running_tied_assistant.csv", sewing.aside)

    first = sewing.needle[0][1:4]
    assistants = "\n".join(
        f'  <Grasper name="assistant_{i + 1}" track="aside" at="{at:.1f} mm" stiffness="10 N/m" rotation_stiffness="0" closing="0.2 s" '
        f'grasp="{grasp:.4g} s" release="{release:.4g} s"/>' for i, (at, grasp, release) in enumerate(sewing.assistants))
    (HERE / "running_tied.xml").write_text(SCENE.format(
        sewn=sewing.end, one=one, two=two, let_go=let_go, cut=cut, duration=cut + 1.5,
        centre=words(first), thread=THREAD, beams=round(THREAD / 0.85), behind=words(BEHIND), end=13 + THREAD - 0.5,
        times=words(k[0] for k in sewing.needle), turns=words(k[4] for k in sewing.needle),
        positions="  ".join(words(plus(k[1:4], first, -1)) for k in sewing.needle),
        holder=[words(t) for t in sewing.holder], puller=[words(t) for t in sewing.puller], assistants=assistants,
        tail_released=one.touch + 0.09, over_taken=let_go - 0.05, over_released=two.touch + 0.1, taken=sewing.end + 0.2,
        cut_off=sewing.end + 0.35, needle_off=words(plus(HAND, OUT, 4.6))))
    print(f"thread {THREAD:.1f} mm, sewn at {sewing.end:.4g} s; throws end at {one.end:.4g} and {two.end:.4g} s")
