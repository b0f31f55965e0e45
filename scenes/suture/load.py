#!/usr/bin/python3
"""Writes load_one.xml, load_two.xml and load_three.xml, and the stitch that they lay out, load_stitch.csv."""
import numpy as np
from stitches import HERE, columns, recorders, stitch

PLACES = {"one": {"middle": 0}, "two": {"front": -4.5, "back": 4.5}, "three": {"front": -6, "middle": 0, "back": 6}}  # y in mm

WOUND = ["/skin/gap_middle.distance", "/skin/gap_end.distance", "/skin/left_clamp.reaction", "/skin/right_clamp.reaction"]

HEAD = """<?xml version="1.0"?>
<!-- A strip of skin is cut across, closed by {count} and pulled apart, as in a machine that tests what a
     wound bears (docs/wound.md). What closes it is there from the start: sewn, with square knots that are as tight as laid.
     to 0.9 s       the ends of each knot are drawn with 20 mN
     0.1 to 0.9 s   the right clamp moves by 2.7 mm
     0.9 to 1.3 s   it rests; the ends are let go, and friction alone holds the knots
     {writer} writes this file. -->
<sutura version="1" dt="10 ms" gravity="0 0 0" duration="1.3 s">
  <plugin name="thread"/> <plugin name="tissue"/> <plugin name="suturing"/> <plugin name="tools"/> <plugin name="contact"/> <plugin name="output"/>

  <node name="skin">
    <TetMesh file="../meshes/strip.msh" unit="mm"/>
    <AsyncPreconditioner lag="3"/>
    <Tissue name="tissue" young="50 kPa" poisson="0.4" density="1000" damping_stiffness="10 ms"/>
    <Attach name="left_clamp" box="-10 -9 -5  -10 9 0 mm"/>
    <Track name="machine" times="0.1 0.9 s" positions="0 0 0  2.7 0 0 mm"/>
    <Attach name="right_clamp" box="10 -9 -5  10 9 0 mm" motion="machine"/>
    <TissueProbe name="left_middle" point="-0.1 0 -2 mm"/> <TissueProbe name="left_end" point="-0.1 9 -2 mm"/>
    <TissueProbe name="right_middle" point="0.1 0 -2 mm"/> <TissueProbe name="right_end" point="0.1 9 -2 mm"/>
    <Distance name="gap_middle" from="left_middle" to="right_middle"/>
    <Distance name="gap_end" from="left_end" to="right_end"/>
  </node>
"""

if __name__ == "__main__":
    laid, probes = stitch(bite=2.5, deep=2.5, name="load_stitch")
    for number, places in PLACES.items():
        text = HEAD.format(count=f"{number} stitch" + ("es" if len(places) > 1 else ""), writer="load.py")
        for name, y in places.items():
            text += laid.node(name, "/skin/tissue", "1 mm", probes, place=lambda p, y=y: p + np.array([0, y, 0]))
        (HERE / f"load_{number}.xml").write_text(text + recorders(WOUND + columns(places, probes), "50 ms"))
