#!/usr/bin/python3
"""Writes anastomosis.xml, and the stitch that it lays out four times, anastomosis_stitch.csv."""
import numpy as np
from stitches import HERE, columns, recorders, stitch

FACES = 24  # of the tube, around
RADIUS = 4 * np.cos(np.pi / FACES)  # mm: in the middle of a face
BETWEEN = 3.5

HEAD = """<?xml version="1.0"?>
<!-- Two ends of a soft tube, 6 and 8 mm in diameter, are joined by four stitches at 0, 90, 180 and 270 degrees (docs/wound.md), each with a
     square knot that is as tight as laid.
     0.1 to 0.2 s   the right end is pushed until the rims meet
     0.2 to 0.7 s   the tube is pulled in length, by 2 mm
     0.7 to 1.1 s   and bent by 15 degrees; meanwhile the ends of the threads, drawn with 20 mN so far, are let go
     anastomosis.py writes this file. -->
<sutura version="1" dt="10 ms" gravity="0 0 0" duration="1.3 s">
  <plugin name="thread"/> <plugin name="tissue"/> <plugin name="suturing"/> <plugin name="tools"/> <plugin name="contact"/> <plugin name="output"/>

  <node name="tube">
    <TetMesh file="../meshes/tube.msh" unit="mm"/>
    <AsyncPreconditioner lag="3"/>
    <Tissue name="tissue" young="100 kPa" poisson="0.4" density="1000" damping_stiffness="10 ms"/>
    <Attach name="left_end" box="-10 -4 -4  -10 4 4 mm"/>
    <Track name="machine" times="0.1 0.2 0.7 1.1 s" positions="0 0 0  -0.6 0 0  2 0 0  2 0 0 mm" rotations="0 0 0  0 0 0  0 0 0  0 15 0 deg"/>
    <Attach name="right_end" box="10 -4 -4  10 4 4 mm" motion="machine"/>
    <Contact name="rims" first="tissue" friction="0"/>
"""


def turned(v, degrees):
    """About the tube's axis."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([v[0], c * v[1] - s * v[2], s * v[1] + c * v[2]])


def gap(degrees):
    _, y, z = turned([0, 0, BETWEEN], degrees)
    return f"""    <TissueProbe name="left_{degrees}" point="-0.1 {y:.4f} {z:.4f} mm"/> <TissueProbe name="right_{degrees}" point="0.1 {y:.4f} {z:.4f} mm"/>
    <Distance name="gap_{degrees}" from="left_{degrees}" to="right_{degrees}"/>
"""


if __name__ == "__main__":
    laid, probes = stitch(bite=2.0, deep=1.4, name="anastomosis_stitch")
    rims = range(0, 360, 45)
    text = HEAD + "".join(gap(degrees) for degrees in rims) + "  </node>\n"
    for degrees in range(0, 360, 90):
        text += laid.node(f"at_{degrees}", "/tube/tissue", "0.5 mm", probes, turn=lambda v, a=degrees: turned(v, a),
                          place=lambda p, a=degrees: turned(p + np.array([0, 0, RADIUS]), a))
    tube = [f"/tube/gap_{degrees}.distance" for degrees in rims] + ["/tube/left_end.reaction", "/tube/right_end.reaction", "/tube/rims.force"]
    text += recorders(tube + columns([f"at_{degrees}" for degrees in range(0, 360, 90)], probes), "50 ms")
    (HERE / "anastomosis.xml").write_text(text)
