#!/usr/bin/env python3
"""Pictures of a recorded run beside each other, seen from above and the front.

    panels.py FOLDER OUT.png --columns 5 --panel 1.2:0,0,1:8 --panel end:-2,0,1:5

FOLDER holds the .pvd files that VtuRecorder writes. A panel is TIME:MIDDLE:HALF_HEIGHT (s, mm, mm). Needs Debian's python3-vtk9 and a
display (xvfb-run gives a virtual one).
"""
import argparse
import os

import vtk

from render import LINE, TETRAHEDRON, Series, actor_of, array, caption, strand_actors, tissue_actors

SIDE = 500  # of a panel (pixels)


def actors_of(grid):
    if grid.GetCellType(0) == TETRAHEDRON:
        return tissue_actors(grid, cut=-1)
    if grid.GetCellType(0) == LINE and (array(grid.GetCellData(), "radius") is not None or array(grid.GetPointData(), "radius") is not None):
        return strand_actors(grid)
    tool = vtk.vtkGeometryFilter()  # tools are recorded as lines
    tool.SetInputData(grid)
    return [actor_of(tool, (0.4, 0.42, 0.45), LineWidth=1.5, Lighting=False)]


def panel(series, time, middle, half_height, towards):
    view = vtk.vtkRenderer()
    view.SetBackground(1, 1, 1)
    for body, s in series.items():
        grid = s.at(time)
        if body == "constraints" or grid.GetNumberOfCells() == 0:
            continue
        for actor in actors_of(grid):
            view.AddActor(actor)
    shown = max(t for s in series.values() for t in s.times if t <= time + 1e-6)
    view.AddActor(caption(f"t = {shown:.1f} s"))
    vtk.vtkLightKit().AddLightsToRenderer(view)
    camera = view.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(*middle)
    camera.SetPosition(*(m - 0.5 * d for m, d in zip(middle, towards)))
    camera.SetViewUp(0, 0, 1)
    camera.SetParallelScale(half_height)
    view.ResetCameraClippingRange()
    return view


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("out")
    parser.add_argument("--panel", action="append", required=True, metavar="TIME:X,Y,Z:HALF_HEIGHT")
    parser.add_argument("--columns", type=int, default=5)
    parser.add_argument("--towards", default="0.35,0.8,-0.5", help="direction of view")
    arguments = parser.parse_args()

    series = {n[:-4]: Series(os.path.join(arguments.folder, n)) for n in sorted(os.listdir(arguments.folder)) if n.endswith(".pvd")}
    end = max(max(s.times) for s in series.values())
    towards = [float(x) for x in arguments.towards.split(",")]
    rows = -(-len(arguments.panel) // arguments.columns)
    window = vtk.vtkRenderWindow()
    window.SetMultiSamples(8)
    window.SetSize(SIDE * min(arguments.columns, len(arguments.panel)), SIDE * rows)
    for i, text in enumerate(arguments.panel):
        time, middle, half_height = text.split(":")
        view = panel(series, end if time == "end" else float(time), [1e-3 * float(x) for x in middle.split(",")], 1e-3 * float(half_height),
                     towards)
        row, column = divmod(i, arguments.columns)
        wide, high = 1 / min(arguments.columns, len(arguments.panel)), 1 / rows
        view.SetViewport(column * wide, 1 - (row + 1) * high, (column + 1) * wide, 1 - row * high)
        window.AddRenderer(view)
    window.SetOffScreenRendering(1)
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(arguments.out)
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()


if __name__ == "__main__":
    main()
