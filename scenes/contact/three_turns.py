#!/usr/bin/env python3
"""The way of the hand of three_turns.xml: it lays a thread on a bar, three turns, and takes it off. Writes three_turns_hand.csv.

The thread leaves the bar along its tangent, so the hand goes along an involute; along the bar each turn advances by PITCH.
"""
import math
import os

RADIUS, REACH, PITCH = 3.1, 90.0, 1.0  # mm: bar and half of the thread; from the bar to its end at the start; of a turn
TAUT = 1.0  # mm: by so much the hand is ahead of the end of the thread
TURNS, TURN_TIME, REST = 3, 0.5, 0.3  # s: of a turn, and before, between and after
KEYS = 36  # a turn


def hand(angle):
    """At this angle of wrap (rad): where the thread leaves the bar, and what is left of it (mm)."""
    slope = PITCH / (2 * math.pi * RADIUS)
    left = REACH - RADIUS * angle * math.hypot(1, slope)
    along = (left + TAUT) / math.hypot(1, slope)
    return (RADIUS * math.sin(angle) + along * math.cos(angle), -RADIUS * math.cos(angle) + along * math.sin(angle),
            PITCH * angle / (2 * math.pi) + along * slope)


def main():
    start = (REACH, -RADIUS, 0)
    rows, time = [(0, start)], REST
    angles = [2 * math.pi * i / KEYS for i in range(TURNS * KEYS + 1)]
    for way in (angles, angles[::-1]):
        for i, angle in enumerate(way):
            rows.append((time + i * TURN_TIME / KEYS, hand(angle)))
        time += TURNS * TURN_TIME + REST
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "three_turns_hand.csv"), "w") as file:
        file.write("t [s],x [mm],y [mm],z [mm]\n")
        for t, place in rows:
            file.write(f"{t:.4f}," + ",".join(f"{a - b:.4f}" for a, b in zip(place, start)) + "\n")


main()
