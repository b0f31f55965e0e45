#!/usr/bin/python3
"""Key frames of the hands that tie the stitch of interrupted.xml, as tables that Track reads. Run it to write them anew.

Lengths are in mm, times in s. What a run has to say first (where the thread comes up, how much of it) stands at the top.
"""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "knots"))
from throws import Throw, plus, table  # noqa: E402

APART = 3.1                    # half of the distance of the two mouths of the channel
LONG, TAIL = 51.2, 13.8        # from the mouths to the hand and to the hold of the tail
HAND = (19.97, -24.39, 40.88)     # where the hand takes the strand
END = (7.8, 0.5, 7.7)          # where the tail is held for the first throw
TAIL_END = (-6.0, 12.6, 3.2)     # where the tail is when the thread has been drawn through

if __name__ == "__main__":
    one = Throw(place=(0, 0, 0), apart=APART, long=LONG, tail=TAIL - APART, end_of_tail=END, pull=4.0, start=5.4)
    hand = [(5.2, *HAND, "the hand takes the strand"), (5.35, *HAND, "the hand takes the strand")] + one.hand
    away = [(6.2, *one.jaws[-1][1:4], "the jaws let go"), (6.5, 45, 0, 10, "the jaws go away")]
    tail = [(0.3, -71.45, 23.04, 28.06, "the tail follows"), (1.6, -60, 17, 13, "the tail follows"),
            (3.0, -48, 15, 10, "the tail follows"), (5.0, *TAIL_END, "the tail is drawn in"), (5.4, -4, 5, 12.5, "and laid over"), (5.8, 4, 3, 11.5, "and laid over"), (6.1, *END, "and laid over")]
    table(HERE / "interrupted_hand.csv", hand)
    table(HERE / "interrupted_jaws.csv", one.jaws)
    table(HERE / "interrupted_tail.csv", tail)
    print(f"grasp {one.grasp:.4g}, let go {one.let_go:.4g} s, end {one.end:.4g} s")
