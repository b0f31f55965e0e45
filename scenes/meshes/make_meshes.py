#!/usr/bin/python3
"""Makes the meshes of this folder from their .geo files with the gmsh program (Debian: gmsh).

The results are committed, so that a scene needs no mesher. Run it again after changing a .geo file.
"""
import pathlib
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
# name, gmsh options: the pad is binary to stay below 1 MB, the block is text to be read by people.
MESHES = [
    ("pad", ["-format", "msh41", "-bin"]),
    ("block", ["-format", "msh22"]),
]

for name, options in MESHES:
    target = HERE / f"{name}.msh"
    subprocess.run(["gmsh", "-3", "-nt", "1", "-v", "2", *options, "-o", str(target), str(HERE / f"{name}.geo")],
                   check=True)
    print(f"{target.name}: {target.stat().st_size} bytes")
