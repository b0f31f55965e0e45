#!/usr/bin/python3
"""Writes running.xml, and the thread that it lays out, running_start.csv: five bites with one thread, whose ends are tied to each other
over the middle of the wound."""
import numpy as np
from load import HEAD, WOUND
from stitches import HERE, KNOT, Laid, arc, columns, recorders

BITES, APART = 5, 3.0  # mm along the wound
BITE, ARCH = 2.5, 1.2  # from the wound to a mouth, and lowest point of a channel; height of a strand from bite to bite
HEIGHT = 1.8           # of the knot, which lies over those strands


def along(bite):
    return (bite - (BITES - 1) / 2) * APART


def to_the_knot(side):
    """From the outermost mouth, up and over the other strands: a Bezier curve."""
    low = HEIGHT - KNOT.apart / 2
    a, b = side * along(BITES - 1), side * BITE
    points = np.array([[a, b, 0], [a, b, 2.6], [side * 3.2, 0, low], [side * KNOT.wide / 2, 0, low]])
    t = np.linspace(0, 1, 90)[:-1, None]
    return (1 - t)**3 * points[0] + 3 * t * (1 - t)**2 * points[1] + 3 * t**2 * (1 - t) * points[2] + t**3 * points[3]


def curve():
    """The wound along x, so that the knot is as lay_knot lays it; bites are along y."""
    left, right = [np.vstack([to_the_knot(side), KNOT.rise([1, -1], side < 0) + [0, 0, HEIGHT]]) for side in (-1, 1)]
    line = [left[::-1]]
    for i in range(BITES):
        x = along(i)
        line.append(arc(180, 360, x, lambda a: BITE * np.cos(a), lambda a: BITE * np.sin(a)))
        if i + 1 < BITES:
            line += [[[x, BITE, 0]], arc(0, 180, lambda a, x=x: x + APART * (1 - np.cos(a)) / 2, lambda a: BITE * np.cos(a),
                                         lambda a: ARCH * np.sin(a)), [[along(i + 1), -BITE, 0]]]
    return np.vstack(line + [right])


def turned(v):
    """The wound along y, as in the strip."""
    return np.array([-v[1], v[0], v[2]])


if __name__ == "__main__":
    laid = Laid(curve(), "running_start")
    probes = {}
    for i in range(BITES):
        probes[f"below_{i + 1}"] = laid.nearest([along(i), 0, -BITE])
        if i + 1 < BITES:
            probes[f"above_{i + 1}"] = laid.nearest([along(i) + APART / 2, 0, ARCH])
    probes["leg"] = laid.nearest(to_the_knot(1)[20])
    text = HEAD.format(count="a running suture of five bites", writer="running.py")
    text += laid.node("suture", "/skin/tissue", "1 mm", probes, place=turned, turn=turned)
    (HERE / "running.xml").write_text(text + recorders(WOUND + columns(["suture"], probes), "50 ms"))
