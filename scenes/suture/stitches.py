"""Stitches for load.py, running.py and anastomosis.py: curves through both lips of a wound, with a square knot on top. Laid out and
not tied, as tight as curves are that do not touch yet. Lengths are in mm; the surface of the tissue is z = 0.
"""
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "knots"))
from lay_knot import Knot, write  # noqa: E402

KNOT = Knot(apart=0.3, wide=2.1, high=0.85, end=5.0)
HEIGHT = 0.95  # of the first throw above the skin
BEAM = 0.2


def arc(start, end, x, y, z):
    """Points at angles from `start` to `end` (degrees), both left out; x, y, z: functions of the angle, or numbers."""
    a = np.radians(np.linspace(start, end, 90)[1:-1])
    return np.column_stack([v(a) if callable(v) else np.full(len(a), v) for v in (x, y, z)])


def loop(bite, deep):
    """Across a wound at x = 0, in the plane y = 0. `bite`: from the wound to a mouth of the channel, which is half an ellipse with its
    lowest point so `deep`."""
    def leg(side):  # from a mouth, upwards, to where the knot begins: a quarter of an ellipse
        wide, high = bite - KNOT.wide / 2, HEIGHT - KNOT.apart / 2
        up = arc(0, 90, lambda a: side * (bite - wide * (1 - np.cos(a))), 0, lambda a: high * np.sin(a))
        return np.vstack([[[side * bite, 0, 0]], up, KNOT.rise([1, -1], side < 0) + [0, 0, HEIGHT]])
    return np.vstack([leg(-1)[::-1], arc(180, 360, lambda a: bite * np.cos(a), 0, lambda a: deep * np.sin(a)), leg(1)])


class Laid:
    """A curve as a table for thread_start_file, and what a scene says of the thread."""

    def __init__(self, points, name):
        self.table = name + ".csv"
        self.line = write(points, HERE / self.table, row=0.05)
        self.s = np.append(0, np.cumsum(np.linalg.norm(np.diff(self.line, axis=0), axis=1)))
        self.length = self.s[-1]
        self.back = self.line[0] - self.line[1]
        self.back /= np.linalg.norm(self.back)

    def nearest(self, point):
        """Abscissa of the place closest to a point."""
        return self.s[np.argmin(np.linalg.norm(self.line - point, axis=1))]

    def node(self, name, tissue, spacing, probes, place=lambda p: p, turn=lambda v: v):
        """Its XML. `probes`: names and abscissae; `place` and `turn` move points and directions. It keeps its shape at rest. The ends are
        drawn along the curve."""
        words = lambda v: " ".join(f"{x + 0:.6g}" for x in np.round(v, 9))  # noqa: E731
        draw = 0.02 * turn(self.back)
        read = "\n".join(f'    <ThreadProbe name="{probe}" at="{s:.3f} mm"/>' for probe, s in probes.items())
        return f"""
  <node name="{name}">
    <SutureThread name="thread" needle_length="0" thread_young="2 GPa" thread_density="1100" thread_diameter="0.2 mm" bending_factor="0.1"
                  damping_stiffness="0.1 ms" damping_mass="500 1/s" thread_length="{self.length:.3f} mm" thread_beams="{self.length / BEAM:.0f}"
                  tip="{words(place(self.line[0]))} mm" tip_direction="{words(turn(self.back))}"
                  plane_normal="{words(turn(np.array([0, -1, 0])))}" thread_start_file="{self.table}" thread_rest_file="{self.table}"/>
    <SuturePath tissue="{tissue}" sewn="true" spacing="{spacing}"/>
    <PathFriction coefficient="0.2" pressure="20 kPa"/>
    <Contact name="touches" first="thread" friction="0.4"/>
    <Contact name="on_skin" first="thread" second="{tissue}" friction="0.3"/>
    <Knots name="knot" contact="touches" rigidify="true"/>
    <ThreadLoad name="first_end" at="0" force="{words(draw)} N" times="0 0.05 0.9 1 s" factors="0 1 1 0"/>
    <ThreadLoad name="last_end" at="{self.length:.3f} mm" force="{words(-draw)} N" times="0 0.05 0.9 1 s" factors="0 1 1 0"/>
{read}
  </node>
"""


def stitch(bite, deep, name):
    """A single stitch, and its probes: below the wound, and above on the right leg, between its mouth and the knot."""
    laid = Laid(loop(bite, deep), name)
    last = laid.s[np.flatnonzero(laid.line[:, 2] < 0)[-1]]
    return laid, {"below": laid.length / 2, "above": last + 0.6}


def columns(names, probes):
    """What a run says of its stitches."""
    each = [f"{probe}.{what}" for probe in probes for what in ("force", "tension")]
    each += ["touches.touches", "on_skin.force", "knot.found", "knot.rigid", "knot.throws", "knot.load", "thread.tip_position"]
    return [f"/{name}/{what}" for name in names for what in each]


def recorders(all_columns, every):
    rows = [" ".join(all_columns[i:i + 5]) for i in range(0, len(all_columns), 5)]
    return f'\n  <VtuRecorder interval="{every}"/>\n  <CsvProbe report="true"\n            columns="' + ("\n" + 21 * " ").join(
        rows) + '"/>\n</sutura>\n'
