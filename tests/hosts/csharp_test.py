"""The host in C# against the command and against Python, to the bit.

    csharp_test.py BUILD     with SUTURA_LIBRARY and PYTHONPATH set, as ctest does
"""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import sutura

SOURCE = Path(__file__).resolve().parents[2]
BUILD = Path(sys.argv.pop(1)).resolve()


class CSharp(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        subprocess.run(["mcs", "-warnaserror", f"-out:{self.folder}/Stitch.exe",
                        SOURCE / "tests/hosts/Stitch.cs"], check=True)

    def host(self, *arguments: object) -> str:
        """From a folder of its own, where out/NAME is."""
        environment = os.environ | {"LD_LIBRARY_PATH": f"{BUILD}/lib"}
        out = subprocess.run(["mono", self.folder / "Stitch.exe", *map(str, arguments)], text=True,
                             cwd=self.folder, env=environment, stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT)
        self.assertEqual(out.returncode, 0, out.stdout)
        return out.stdout

    def test_gives_the_bits_of_the_command(self):
        scene = SOURCE / "scenes/suture/prick.xml"
        said = self.host(scene, 20, "/grasper.force", "state")
        self.assertIn("as it must be: the simulation of this handle has been destroyed", said)
        subprocess.run([BUILD / "bin/sutura", "run", scene, "--steps", "20", "--checkpoint-every",
                        "0.2", "--output", self.folder / "theirs"], check=True, capture_output=True)
        self.assertEqual((self.folder / "state").read_bytes(),
                         (self.folder / "theirs/checkpoint.sutura").read_bytes())
        self.assertEqual((self.folder / "out/prick/probe.csv").read_bytes(),
                         (self.folder / "theirs/probe.csv").read_bytes())

    def test_a_tool_that_it_moves(self):
        scene = SOURCE / "scenes/components/Grasper.xml"
        self.host(scene, 30, "/grasper.force", "state", "/track")
        sim = sutura.load(scene)
        for _ in range(30):
            position, quaternion = sim["/track"].pose
            sim["/track"].pose = position + [0, 0, 1e-4], quaternion
            sim.step()
        self.assertEqual((self.folder / "state").read_bytes(), sim.save())


if __name__ == "__main__":
    unittest.main()
