"""A needle driven by hand: until it is through the skin, then let go, then taken back and held."""
import numpy as np
import sutura

sim = sutura.load(sutura.scenes / "suture/prick.xml")
needle, skin = sim["/suture"], sim["/skin/tissue"]
print(f"{len(needle.positions)} points of needle and thread, {len(skin.cells)} tetrahedra of skin")

# The hand turns the needle about the centre of its arc, a quarter of a degree in each step.
angle = 0.0
while sim["/puncture.punctures"] < 1:
    angle += np.radians(0.25)
    sim["/track.rotation"] = [0, -angle, 0]
    report = sim.step()
    if not report.solved:
        print(f"step {report.step} has missed its tolerances")
print(f"through after {np.degrees(angle):.1f} degrees, at {sim['/puncture.peak_force']:.3f} N")

# What if it is let go? And what if it is not? Both begin in the same state.
here = sim.save()
for hold in (0, 1):
    sim.restore(here)
    tip = needle.positions[0]
    sim["/grasper.hold"] = hold
    sim.step(20)
    moved = 1e3 * np.linalg.norm(needle.positions[0] - tip)
    print(f"{'held' if hold else 'let go'}: the tip moves by {moved:.3f} mm")
