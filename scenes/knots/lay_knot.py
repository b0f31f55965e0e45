#!/usr/bin/python3
"""Lays a thread out as a knot of throws upon each other: a table for thread_start_file, without twisting the thread.

    lay_knot.py +- square_start.csv       each throw is + or -, right-handed or left-handed

Throws of alternating hand make a square knot, of the same hand a granny. Below the knot the thread goes round a wide
loop; its loose ends go out to both sides above. The two legs of the loop are held at x = -6 and 6 mm, to be pulled
apart: slip.xml. Printed is what the scene has to say.
"""
import sys

import numpy as np

LEG, LOOP = 6.0, 1.5  # mm: from the middle to where a leg is held, radius of the loop


def half_circle(start, end, side):
    """In the x z plane, from one point to the other, bulging to x = +-1 * side."""
    middle, r = (start + end) / 2, np.linalg.norm(end - start) / 2
    a = np.linspace(0, np.pi, 60)[1:-1, None]
    return middle + np.cos(a) * (start - middle) + r * np.sin(a) * np.array([side, 0, 0])


class Knot:
    """Throws upon each other, the first one at z = 0. Lengths in mm: `apart`, of the strands in a throw; `wide`, of a throw;
    `high`, from throw to throw; `end`, of a loose end."""

    def __init__(self, apart=0.44, wide=3.4, high=1.5, end=8.0):
        self.apart, self.wide, self.high, self.end = apart, wide, high, end

    def strand(self, number, hand, from_left):
        """Of one throw: three half turns about x, from below on its own side to above on the other."""
        u = np.linspace(0, 1, 400)
        a = -np.pi / 2 + hand * 3 * np.pi * (u - np.sin(2 * np.pi * u) / (2 * np.pi)) + (0 if from_left else np.pi)
        r = self.apart / 2
        points = np.column_stack([(u - 0.5) * self.wide, r * np.cos(a), number * self.high + r * np.sin(a)])
        return points if from_left else points[::-1]

    def rise(self, hands, from_left):
        """From below the knot on its side, up through all throws, to its loose end."""
        line = []
        for i, hand in enumerate(hands):
            next_one = self.strand(i, hand, from_left == (i % 2 == 0))
            if i > 0:
                line.append(half_circle(line[-1][-1], next_one[0], np.sign(next_one[0][0])))
            line.append(next_one)
        last = line[-1][-1]
        line.append(np.array([last + [np.sign(last[0]) * self.end, 0, 0]]))
        return np.vstack(line)


def curve(knot, hands):
    low = -knot.apart / 2
    left, right = [np.vstack([[[side * LEG, 0, low]], knot.rise(hands, side < 0)]) for side in (-1, 1)]
    down = np.array([0, 0, -2 * LOOP])
    return np.vstack([left[::-1], half_circle(left[0], left[0] + down, -1), [left[0] + down, right[0] + down],
                      half_circle(right[0] + down, right[0], 1), right])


def evenly(line, step):
    s = np.append(0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1)))
    keep = np.append(True, np.diff(s) > 1e-9)
    at = np.linspace(0, s[-1], round(s[-1] / step) + 1)
    return np.column_stack([np.interp(at, s[keep], line[keep, k]) for k in range(3)])


def table(points):
    """Rows of (s, curvature, side curvature): frames that turn as little as they can from one edge to the next."""
    edges = np.diff(points, axis=0)
    lengths = np.linalg.norm(edges, axis=1)
    t = edges / lengths[:, None]
    z = np.array([0., -1, 0]) - t[0] * -t[0][1]
    z /= np.linalg.norm(z)
    rows, s = [(0., 0., 0.)], lengths[0] / 2
    for i in range(len(t) - 1):
        h = (lengths[i] + lengths[i + 1]) / 2
        turn = np.cross(t[i], t[i + 1])
        sine = np.linalg.norm(turn)
        rate = np.zeros(3) if sine < 1e-12 else turn / sine * np.arctan2(sine, t[i] @ t[i + 1]) / h
        rows.append((s, 1e3 * -(rate @ z), 1e3 * (rate @ np.cross(z, t[i]))))
        if sine > 1e-12:  # the frame turns with the tangent
            k, a = turn / sine, np.arctan2(sine, t[i] @ t[i + 1])
            z = z * np.cos(a) + np.cross(k, z) * np.sin(a) + k * (k @ z) * (1 - np.cos(a))
        s += h
    rows.append((s, 0., 0.))
    return rows, s + lengths[-1] / 2


def write(points, name, row=0.1):
    """The table of a curve, a row each 0.1 mm or so, and what a scene has to say of it. Returns the points that were laid out: evenly,
    and smoother."""
    points = evenly(points, row)
    for _ in range(3):  # the joints of straight and bent
        points[1:-1] = (points[:-2] + 2 * points[1:-1] + points[2:]) / 4
    rows, length = table(points)
    with open(name, "w") as file:
        file.write("s [mm], curvature [1/m], side_curvature [1/m]\n")
        file.writelines(f"{s:.5g}, {k:.6g}, {side:.6g}\n" for s, k, side in rows)
    back = points[0] - points[1]
    back /= np.linalg.norm(back)
    print(f"thread_length {length:.3f} mm, tip", *points[0].round(4), "mm, tip_direction", *back.round(6))
    return points


def main(hands, name):
    """Lays a knot out; returns what a scene has to say of it, in mm."""
    knot = Knot()
    points = write(curve(knot, [1 if c == "+" else -1 for c in hands]), name)
    s = np.append(0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    low = np.abs(points[:, 2] + knot.apart / 2) < 0.05
    left, right = (s[low][np.argmin(np.abs(points[low][:, 0] - x))] for x in (-LEG, LEG))
    print(f"left {left:.3f} mm, right {right:.3f} mm")
    return {"length": s[-1], "tip": points[0], "left": left, "right": right}


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
