#!/usr/bin/python3
"""Writes two_layers in every form the readers take, with programs that are not ours: gmsh, VTK, meshio.

The results are committed; Debian packages gmsh, python3-vtk9, python3-meshio.
"""
import pathlib
import re
import subprocess

import vtk

HERE = pathlib.Path(__file__).resolve().parent
GEO = HERE / "two_layers.geo"


def gmsh(name, *options):
    target = HERE / name
    subprocess.run(["gmsh", "-3", "-nt", "1", "-v", "2", *options, "-o", str(target), str(GEO)], check=True)
    return target


gmsh("msh22_ascii.msh", "-format", "msh22")
gmsh("msh22_binary.msh", "-format", "msh22", "-bin")
gmsh("msh41_ascii.msh", "-format", "msh41")
gmsh("msh41_binary.msh", "-format", "msh41", "-bin")
gmsh("gmsh_ascii.vtk", "-format", "vtk")
gmsh("gmsh_binary.vtk", "-format", "vtk", "-bin")

# The grid again, from the ASCII file, into VTK's own writers.
text = (HERE / "msh22_ascii.msh").read_text()
section = lambda name: re.search(rf"\${name}\n\d+\n(.*?)\$End", text, re.S).group(1).split("\n")
points, number = vtk.vtkPoints(), {}
points.SetDataTypeToDouble()
for line in filter(None, section("Nodes")):
    tag, *x = line.split()
    number[tag] = points.InsertNextPoint(*map(float, x))
grid, region = vtk.vtkUnstructuredGrid(), vtk.vtkIntArray()
grid.SetPoints(points)
region.SetName("region")
for line in filter(None, section("Elements")):
    words = line.split()
    if words[1] != "4":
        continue
    ids = vtk.vtkIdList()
    for tag in words[-4:]:
        ids.InsertNextId(number[tag])
    grid.InsertNextCell(vtk.VTK_TETRA, ids)
    region.InsertNextValue(int(words[3]))
grid.GetCellData().AddArray(region)
height = vtk.vtkDoubleArray()  # something to be skipped
height.SetName("height")
for i in range(points.GetNumberOfPoints()):
    height.InsertNextValue(points.GetPoint(i)[2])
grid.GetPointData().AddArray(height)
grid.GetPointData().SetActiveScalars("height")
grid.GetCellData().SetActiveScalars("region")


def write(writer, name, **settings):
    writer.SetFileName(str(HERE / name))
    writer.SetInputData(grid)
    for key, value in settings.items():
        getattr(writer, key)(value)
    writer.Write()


for version in (42, 51):
    for kind, call in (("ascii", "SetFileTypeToASCII"), ("binary", "SetFileTypeToBinary")):
        writer = vtk.vtkUnstructuredGridWriter()
        writer.SetFileVersion(version)
        getattr(writer, call)()
        write(writer, f"vtk{version}_{kind}.vtk")

XML = vtk.vtkXMLUnstructuredGridWriter
for name, mode, header, order in (("ascii", 0, 1, 0), ("base64", 1, 1, 0), ("base64_uint64_big", 1, 2, 1), ("appended_raw", 2, 2, 0),
                                  ("appended_base64", 2, 1, 0)):
    writer = XML()
    writer.SetCompressorTypeToNone()
    writer.SetDataMode(mode)
    writer.SetHeaderType(32 if header == 1 else 64)
    writer.SetByteOrder(vtk.vtkXMLWriter.BigEndian if order else vtk.vtkXMLWriter.LittleEndian)
    writer.SetEncodeAppendedData(name == "appended_base64")
    write(writer, f"{name}.vtu")
compressed = XML()
compressed.SetDataModeToBinary()
write(compressed, "compressed.vtu")
blocks = XML()
blocks.SetBlockSize(256)  # so that even this mesh takes several
blocks.SetDataModeToAppended()
blocks.SetEncodeAppendedData(False)
blocks.SetHeaderTypeToUInt64()
write(blocks, "compressed_blocks_raw.vtu")
blocks.SetEncodeAppendedData(True)
blocks.SetByteOrderToBigEndian()
write(blocks, "compressed_blocks_big.vtu")

# As meshio writes by default.
import meshio
mesh = meshio.read(HERE / "ascii.vtu")
mesh.write(HERE / "meshio.vtu")
