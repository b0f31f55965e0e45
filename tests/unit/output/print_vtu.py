"""Prints what VTK reads from .vtu files. Any message of VTK counts as a failure."""
import os
import sys

from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader


def numbers(array):
    return " ".join(
        repr(float(array.GetComponent(i, k)))
        for i in range(array.GetNumberOfTuples())
        for k in range(array.GetNumberOfComponents()))


failed = []
for path in sys.argv[1:]:
    reader = vtkXMLUnstructuredGridReader()
    for event in ("ErrorEvent", "WarningEvent"):
        reader.AddObserver(event, lambda *_: failed.append(path))
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    types = sorted({grid.GetCellType(i) for i in range(grid.GetNumberOfCells())})
    fields = grid.GetFieldData()
    print(os.path.basename(path), "points", grid.GetNumberOfPoints(), "cells", grid.GetNumberOfCells(),
          "types", " ".join(map(str, types)), "time", fields.GetArray("TimeValue").GetComponent(0, 0))
    for kind, data in (("point", grid.GetPointData()), ("cell", grid.GetCellData())):
        for i in range(data.GetNumberOfArrays()):
            if data.GetArray(i).GetNumberOfTuples():
                print(f"  {kind} {data.GetArrayName(i)}: {numbers(data.GetArray(i))}")
    for i in range(fields.GetNumberOfArrays()):
        if fields.GetArrayName(i) != "TimeValue":
            print(f"  field {fields.GetArrayName(i)}: {numbers(fields.GetArray(i))}")
sys.exit(1 if failed else 0)
