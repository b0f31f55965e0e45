"""Stitches for load.py and anastomosis.py: a loop through both lips of a wound, half an ellipse in the tissue, with a square knot
on top. Laid out and not tied, as tight as curves are that do not touch yet. Lengths are in mm.

A stitch lies in the plane y = 0 across a wound at x = 0, and the surface of the tissue is z = 0.
"""
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "knots"))
from lay_knot import Knot, write  # noqa: E402

KNOT = Knot(apart=0.3, wide=2.1, high=0.85, end=5.0)
HEIGHT = 0.95  # of the first throw above the skin


def to_the_knot(side, bite):
    """From a mouth, upwards, to where the knot begins: a quarter of an ellipse."""
    a = np.linspace(0, np.pi / 2, 40)[:-1, None]
    wide, high = bite - KNOT.wide / 2, HEIGHT - KNOT.apart / 2
    return np.hstack([side * (bite - wide * (1 - np.cos(a))), 0 * a, high * np.sin(a)])


class Stitch:
    """`bite`: from the wound to a mouth of the channel; `deep`: its lowest point; `name` of its table."""

    def __init__(self, bite, deep, name):
        up = np.array([0, 0, HEIGHT])
        left, right = [np.vstack([to_the_knot(side, bite), KNOT.rise([1, -1], side < 0) + up]) for side in (-1, 1)]
        a = np.linspace(0, np.pi, 90)[1:-1, None]
        below = np.hstack([-bite * np.cos(a), 0 * a, -deep * np.sin(a)])
        self.table = name + ".csv"
        line = write(np.vstack([left[::-1], below, right]), HERE / self.table, row=0.05)
        s = np.append(0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1)))
        self.tip, self.length = line[0], s[-1]
        self.below = s[-1] / 2
        self.above = s[np.flatnonzero(line[:, 2] < 0)[-1]] + 0.6  # of the right leg, between its mouth and the knot

    def node(self, name, tissue, spacing, place=lambda p: p, turn=lambda v: v):
        """Its XML, where `place` and `turn` move points and directions."""
        words = lambda v: " ".join(f"{x + 0:.6g}" for x in np.round(v, 9))  # noqa: E731
        return f"""
  <node name="{name}">
    <SutureThread name="thread" needle_length="0" thread_young="2 GPa" thread_density="1100" thread_diameter="0.2 mm" bending_factor="0.1"
                  damping_stiffness="0.1 ms" damping_mass="500 1/s" thread_length="{self.length:.3f} mm" thread_beams="170"
                  tip="{words(place(self.tip))} mm" tip_direction="-1 0 0" plane_normal="{words(turn(np.array([0, -1, 0])))}"
                  thread_start_file="{self.table}" thread_rest_file="{self.table}"/>
    <SuturePath tissue="{tissue}" sewn="true" spacing="{spacing}"/>
    <PathFriction coefficient="0.2" pressure="20 kPa"/>
    <Contact name="touches" first="thread" friction="0.4"/>
    <Contact name="on_skin" first="thread" second="{tissue}" friction="0.3"/>
    <Knots name="knot" contact="touches" rigidify="true"/>
    <ThreadLoad name="first_end" at="0" force="-0.02 0 0 N" times="0 0.05 s" factors="0 1"/>
    <ThreadLoad name="last_end" at="{self.length:.3f} mm" force="0.02 0 0 N" times="0 0.05 s" factors="0 1"/>
    <ThreadProbe name="below" at="{self.below:.3f} mm"/>
    <ThreadProbe name="above" at="{self.above:.3f} mm"/>
  </node>
"""


def columns(names):
    """What a run says of its stitches."""
    each = ["below.force", "above.force", "below.tension", "above.tension", "touches.touches", "on_skin.force", "knot.found", "knot.rigid",
            "knot.throws", "knot.load", "thread.tip_position"]
    return [f"/{name}/{what}" for name in names for what in each]


def recorders(all_columns, every):
    rows = [" ".join(all_columns[i:i + 5]) for i in range(0, len(all_columns), 5)]
    return f'\n  <VtuRecorder interval="{every}"/>\n  <CsvProbe report="true"\n            columns="' + ("\n" + 21 * " ").join(
        rows) + '"/>\n</sutura>\n'
