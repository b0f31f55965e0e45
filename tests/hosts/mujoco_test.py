"""The exchange with MuJoCo: its energy; Sutura gives the same forces for the same poses."""

import importlib.util
import sys
import unittest
from pathlib import Path

import numpy as np
import sutura

SOURCE = Path(__file__).resolve().parents[2]
HAS_MUJOCO = importlib.util.find_spec("mujoco") is not None


@unittest.skipUnless(HAS_MUJOCO, "MuJoCo is not installed")
class Exchange(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        sutura.scenes = SOURCE / "scenes"
        sys.path.insert(0, str(SOURCE / "docs/embed/examples"))
        import mujoco_gripper
        cls.coarse, cls.fine = (mujoco_gripper.run(dt) for dt in (10e-3, 5e-3))

    def test_the_needle_goes_in(self):
        for r in (self.coarse, self.fine):
            self.assertEqual(r["punctures"], 1)
            # The threshold of the skin is 0.3 N; the jaws bear it and the weight, in part.
            self.assertAlmostEqual(np.linalg.norm(r["forces"], axis=1).max(), 0.3, delta=0.02)

    def test_the_hand_feels_it(self):
        """The servo is behind by what its damping and the needle ask of it: both push back."""
        damping = 0.01 * np.radians(100) / 0.5
        self.assertGreater(self.coarse["late"], damping)

    def test_energy(self):
        """Each side works with the force that it has, one exchange apart: the error is of first
        order in the interval, and small against the work."""
        made = [abs(r["taken"] - r["given"]) for r in (self.coarse, self.fine)]
        self.assertLess(made[0], 0.03 * abs(self.coarse["taken"]))
        self.assertLess(made[1], 0.65 * made[0])

    def test_the_same_poses_give_the_same_forces(self):
        sim = sutura.load(SOURCE / "scenes/suture/prick.xml")
        forces = []
        for pose in self.coarse["poses"]:
            sim["/track"].pose = pose
            sim.step()
            forces.append(sim["/grasper.force"])
        np.testing.assert_array_equal(np.array(forces), self.coarse["forces"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
