"""Bodies as a small SVG, without a plotting library."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

#: Rows: right, up and towards the viewer, who looks along y from the front, a little from above
#: and from the right.
_TURN, _TILT = np.radians(20), np.radians(20)
_VIEW = np.array([
    [np.cos(_TURN), np.sin(_TURN), 0],
    [-np.sin(_TURN) * np.sin(_TILT), np.cos(_TURN) * np.sin(_TILT), np.cos(_TILT)],
    [np.sin(_TURN) * np.cos(_TILT), -np.cos(_TURN) * np.cos(_TILT), np.sin(_TILT)],
])
_MOST_TRIANGLES = 6000  # a picture, not a data set
_MARGIN = 12.0
_LIGHT = np.array([0.3, 0.8, 0.52])  # where it comes from
_SKIN = (244, 205, 185)
_COLOURS = ("#1f5fa8", "#2b8a3e", "#862e9c", "#c2255c")


def boundary(tetrahedra: NDArray[np.int64]) -> NDArray[np.int64]:
    """Triangles that belong to one tetrahedron only, n x 3."""
    faces = tetrahedra[:, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]].reshape(-1, 3)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True,
                                return_counts=True)
    outer: NDArray[np.int64] = faces[first[count == 1]]
    return outer


def _triangles(seen: NDArray[np.float64], cells: NDArray[np.int64],
               height: float) -> list[tuple[float, str]]:
    """Depth and SVG of each triangle of the boundary that faces the viewer."""
    a, b, c = (seen[corner] for corner in boundary(cells).T)
    normal = np.cross(b - a, c - a)
    facing = np.flatnonzero(normal[:, 2] > 0)
    out = []
    for i in facing[::max(1, -(-facing.size // _MOST_TRIANGLES))]:
        light = 0.55 + 0.45 * max(0.0, float(normal[i] @ _LIGHT / np.linalg.norm(normal[i])))
        red, green, blue = (int(light * k) for k in _SKIN)
        corners = " ".join(f"{p[0]:.1f},{height - p[1]:.1f}" for p in (a[i], b[i], c[i]))
        fill = f"rgb({red},{green},{blue})"
        out.append((float(a[i][2] + b[i][2] + c[i][2]),
                    f'<polygon points="{corners}" fill="{fill}" stroke="{fill}" '
                    'stroke-width="0.3"/>'))
    return out


def svg(bodies: Sequence[tuple[str, Any]], width: int) -> str:
    """`bodies`: paths and shapes (points n x 3, cells x 2 or x 4). Curves are drawn over solids,
    so that a thread is seen inside of a tissue too."""
    bodies = [(path, s) for path, s in bodies
              if len(s.cells) and np.isfinite(s.points).all()]
    if not bodies:
        return '<svg xmlns="http://www.w3.org/2000/svg" width="10" height="10"></svg>'
    views = [s.points @ _VIEW.T for _, s in bodies]
    low = np.min([v.min(axis=0) for v in views], axis=0)
    span = np.max([v.max(axis=0) for v in views], axis=0) - low
    scale = (width - 2 * _MARGIN) / max(span[0], span[1], 1e-9)
    height = scale * span[1] + 2 * _MARGIN
    solids: list[tuple[float, str]] = []
    curves: list[str] = []
    for number, ((path, shape), view) in enumerate(zip(bodies, views)):
        seen = (view - low) * scale + _MARGIN
        if shape.cells.shape[1] == 4:
            solids += _triangles(seen, shape.cells, height)
            continue
        line = "".join(f"M{seen[i][0]:.1f},{height - seen[i][1]:.1f}"
                       f"L{seen[j][0]:.1f},{height - seen[j][1]:.1f}" for i, j in shape.cells)
        curves.append(f'<path d="{line}" fill="none" stroke="{_COLOURS[number % len(_COLOURS)]}" '
                      f'stroke-width="1.6" stroke-linecap="round"><title>{escape(path)}</title>'
                      '</path>')
    solids.sort(key=lambda depth_and_text: depth_and_text[0])
    inside = "".join(text for _, text in solids) + "".join(curves)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height:.0f}" '
            f'viewBox="0 0 {width} {height:.0f}">{inside}</svg>')
