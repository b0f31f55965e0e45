#!/usr/bin/env python3
"""Pictures of a recorded run: tissue cut open, needle and thread as tubes, constraint forces as arrows.

    render.py FOLDER --prefix out/first_stitch --frame before=1.0 --frame pierced=2.6 --frame pulled=end

FOLDER holds the .pvd files that VtuRecorder writes. A frame is NAME=TIME (s; "end": the last record) and
becomes PREFIX_NAME.png. Needs Debian's python3-vtk9 and a display (xvfb-run gives a virtual one).
"""
import argparse
import os
import sys
import xml.etree.ElementTree as xml

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

LAYER_COLOURS = [(0.93, 0.72, 0.62), (0.96, 0.87, 0.58), (0.72, 0.32, 0.30), (0.60, 0.40, 0.45)]
STEEL, SUTURE, ARROW = (0.78, 0.80, 0.83), (0.10, 0.22, 0.68), (0.80, 0.10, 0.10)
TETRAHEDRON, LINE = 10, 3


class Series:
    """One .pvd: times and files."""

    def __init__(self, path):
        folder = os.path.dirname(path)
        entries = [(float(d.get("timestep")), os.path.join(folder, d.get("file")))
                   for d in xml.parse(path).getroot().iter("DataSet")]
        self.times = [t for t, _ in entries]
        self.files = [f for _, f in entries]

    def at(self, time):
        nearest = min(range(len(self.times)), key=lambda i: abs(self.times[i] - time))
        reader = vtk.vtkXMLUnstructuredGridReader()
        reader.SetFileName(self.files[nearest])
        reader.Update()
        return reader.GetOutput()


def array(data, start):
    """The first array whose name begins with `start`, or None."""
    for i in range(data.GetNumberOfArrays()):
        if data.GetArrayName(i).startswith(start):
            return vtk_to_numpy(data.GetArray(i))
    return None


def actor_of(source, colour, **properties):
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(colour)
    for name, value in properties.items():
        getattr(actor.GetProperty(), "Set" + name)(value)
    return actor


def vtk_centres(grid):
    centres = vtk.vtkCellCenters()
    centres.SetInputData(grid)
    centres.Update()
    return centres.GetOutput().GetPoints().GetData()


def tissue_actors(grid, cut):
    """Each layer in its colour, the part in front of the plane y = cut taken away."""
    regions = array(grid.GetCellData(), "region")
    if regions is None:
        regions = np.zeros(grid.GetNumberOfCells())
    heights = vtk_to_numpy(vtk_centres(grid))[:, 2]
    from_the_top = sorted(set(regions), key=lambda r: -heights[regions == r].mean())
    for k, region in enumerate(from_the_top):
        layer = vtk.vtkExtractCells()
        layer.SetInputData(grid)
        cells = vtk.vtkIdList()
        for i in np.flatnonzero(regions == region):
            cells.InsertNextId(int(i))
        layer.SetCellList(cells)
        plane = vtk.vtkPlane()
        plane.SetOrigin(0, cut, 0)
        plane.SetNormal(0, 1, 0)
        clip = vtk.vtkClipDataSet()
        clip.SetInputConnection(layer.GetOutputPort())
        clip.SetClipFunction(plane)
        surface = vtk.vtkDataSetSurfaceFilter()
        surface.SetInputConnection(clip.GetOutputPort())
        normals = vtk.vtkPolyDataNormals()
        normals.SetInputConnection(surface.GetOutputPort())
        normals.SetFeatureAngle(40)
        yield actor_of(normals, LAYER_COLOURS[k % len(LAYER_COLOURS)], Ambient=0.45, Diffuse=0.65)
        edges = vtk.vtkFeatureEdges()
        edges.SetInputConnection(surface.GetOutputPort())
        edges.ManifoldEdgesOff()
        edges.NonManifoldEdgesOff()
        edges.SetFeatureAngle(40)
        yield actor_of(edges, (0.45, 0.32, 0.28), LineWidth=1.5, Lighting=False)


def strands(grid):
    """Runs of consecutive lines of one radius: (radius, points, drawn radius of the first)."""
    points = vtk_to_numpy(grid.GetPoints().GetData())
    ends = [(grid.GetCell(i).GetPointId(0), grid.GetCell(i).GetPointId(1))
            for i in range(grid.GetNumberOfCells())]
    radii = array(grid.GetCellData(), "radius")
    if radii is None:
        on_points = array(grid.GetPointData(), "radius")
        radii = (np.full(len(ends), 1e-4) if on_points is None else
                 np.array([0.5 * (on_points[a] + on_points[b]) for a, b in ends]))
    runs = []
    for (a, b), radius in zip(ends, radii):
        if runs and runs[-1][0] == radius and runs[-1][1][-1] == a:
            runs[-1][1].append(b)
        else:
            runs.append((radius, [a, b]))
    drawn = array(grid.GetPointData(), "drawn radius")
    first = [radius if drawn is None else min(radius, drawn[nodes[0]]) for radius, nodes in runs]
    return [(radius, points[nodes], r) for (radius, nodes), r in zip(runs, first)]


def tube(radius, points, first_radius, colour, is_steel=False):
    data = vtk.vtkPolyData()
    vtk_points = vtk.vtkPoints()
    vtk_points.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    line = vtk.vtkCellArray()
    line.InsertNextCell(len(points))
    for i in range(len(points)):
        line.InsertCellPoint(i)
    data.SetPoints(vtk_points)
    data.SetLines(line)
    radii = np.full(len(points), radius)
    radii[0] = first_radius  # a needle ends in a point
    data.GetPointData().SetScalars(numpy_to_vtk(radii, deep=True))
    # The cubic through the nodes: a needle of a few beams is drawn round, as it is computed.
    smooth = vtk.vtkSplineFilter()
    smooth.SetInputData(data)
    smooth.SetSubdivideToSpecified()
    smooth.SetNumberOfSubdivisions(6 * len(points))
    out = vtk.vtkTubeFilter()
    out.SetInputConnection(smooth.GetOutputPort())
    out.SetVaryRadiusToVaryRadiusByAbsoluteScalar()
    out.SetNumberOfSides(16)
    out.CappingOn()
    steel = {"Specular": 0.5, "SpecularPower": 40} if is_steel else {"Specular": 0.2, "SpecularPower": 20}
    return actor_of(out, colour, Ambient=0.2, **steel)


def strand_actors(grid):
    runs = strands(grid)
    thickest = max((r for r, _, _ in runs), default=0)
    thinnest = min((r for r, _, _ in runs), default=0)
    for radius, points, first_radius in runs:
        needle = radius == thickest and thickest > 1.5 * thinnest
        yield tube(radius, points, first_radius, STEEL if needle else SUTURE, needle)


def largest_force(grid):
    force = array(grid.GetPointData(), "force")
    return 0.0 if force is None else float(np.linalg.norm(force.reshape(-1, 3), axis=1).max(initial=0))


def arrow_actors(grid, length_per_newton, thickness):
    force = array(grid.GetPointData(), "force")
    if force is None:
        return
    points = vtk_to_numpy(grid.GetPoints().GetData())
    for p, f in zip(points, force.reshape(-1, 3)):
        length = np.linalg.norm(f) * length_per_newton
        if length < 3 * thickness:
            continue
        arrow = vtk.vtkArrowSource()
        arrow.SetShaftRadius(thickness / length)
        arrow.SetTipRadius(2.5 * thickness / length)
        arrow.SetTipLength(min(0.5, 6 * thickness / length))
        arrow.SetTipResolution(16)
        arrow.SetShaftResolution(12)
        x = f / np.linalg.norm(f)
        y = np.cross(x, (0, 1, 0) if abs(x[1]) < 0.9 else (1, 0, 0))
        y /= np.linalg.norm(y)
        frame = np.eye(4)
        frame[:3, 0], frame[:3, 1], frame[:3, 2], frame[:3, 3] = (
            length * x, length * y, length * np.cross(x, y), p)
        move = vtk.vtkTransform()
        move.SetMatrix(frame.flatten())
        placed = vtk.vtkTransformPolyDataFilter()
        placed.SetInputConnection(arrow.GetOutputPort())
        placed.SetTransform(move)
        yield actor_of(placed, ARROW, Ambient=0.3)


def caption(text):
    actor = vtk.vtkTextActor()
    actor.SetInput(text)
    style = actor.GetTextProperty()
    style.SetFontSize(24)
    style.SetColor(0.15, 0.15, 0.15)
    actor.SetPosition(24, 20)
    return actor


def picture(actors, text, view, size, path):
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    for actor in actors:
        renderer.AddActor(actor)
    renderer.AddActor2D(caption(text))
    lights = vtk.vtkLightKit()
    lights.AddLightsToRenderer(renderer)
    centre, half_height = view
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(*centre)
    camera.SetPosition(*(np.asarray(centre) + np.array([0.25, -1.0, 0.35])))
    camera.SetViewUp(0, 0, 1)
    camera.SetParallelScale(half_height)
    renderer.ResetCameraClippingRange()
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(*size)
    window.AddRenderer(renderer)
    window.Render()
    shot = vtk.vtkWindowToImageFilter()
    shot.SetInput(window)
    shot.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputConnection(shot.GetOutputPort())
    writer.Write()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--prefix", required=True)
    parser.add_argument("--frame", action="append", required=True, metavar="NAME=TIME")
    parser.add_argument("--cut", type=float, default=0.5e-3, help="tissue with y below this (m) is not drawn")
    parser.add_argument("--half-height", type=float, default=0.0, help="of the picture (m); 0: from the tissue")
    parser.add_argument("--size", type=int, nargs=2, default=(1200, 900))
    arguments = parser.parse_args()

    names = sorted(n for n in os.listdir(arguments.folder) if n.endswith(".pvd"))
    series = {n[:-4]: Series(os.path.join(arguments.folder, n)) for n in names}
    if not series or not all(s.files for s in series.values()):
        sys.exit(f"{arguments.folder}: no .pvd with records")
    end = max(max(s.times) for s in series.values())
    frames = [(n, end if t == "end" else float(t)) for n, t in (f.split("=") for f in arguments.frame)]

    forces = [largest_force(series["constraints"].at(t)) for _, t in frames] if "constraints" in series else []
    largest = max(forces, default=0.0)
    view = None
    for name, time in frames:
        actors = []
        for body, s in series.items():
            grid = s.at(time)
            if body == "constraints" or grid.GetNumberOfCells() == 0:
                continue
            if grid.GetCellType(0) == TETRAHEDRON:
                if view is None:
                    low_x, high_x, _, _, _, top = grid.GetBounds()
                    width = high_x - low_x
                    half_height = arguments.half_height or 0.45 * width
                    view = ((0.5 * (low_x + high_x), 0, top + 0.3 * half_height), half_height)
                actors += tissue_actors(grid, arguments.cut)
            elif grid.GetCellType(0) == LINE:
                actors += strand_actors(grid)
        if view is None:
            bounds = np.array(series[names[0][:-4]].at(time).GetBounds()).reshape(3, 2)
            view = (bounds.mean(axis=1), arguments.half_height or 0.6 * np.ptp(bounds, axis=1).max() + 1e-3)
        text = f"t = {time:.2f} s"
        if largest > 0:
            grid = series["constraints"].at(time)
            actors += arrow_actors(grid, 0.3 * view[1] / largest, 0.006 * view[1])
            text += f"    arrows: constraint forces, largest {largest_force(grid):.2f} N"
        path = f"{arguments.prefix}_{name}.png"
        picture(actors, text, view, arguments.size, path)
        print(path)


if __name__ == "__main__":
    main()
