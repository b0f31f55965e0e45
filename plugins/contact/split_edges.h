// Nodes on the long edges of a tool: a tissue between two of its corners would touch nothing.
#pragma once

#include "triangle_mesh.h"

namespace sutura::contact {

/// Halves edges at which a closed surface is convex until none of them is longer than `longest`
/// (m; 0: none is halved). The surface stays what it is; it only has more nodes. Triangles are
/// halved at their longest edge first, so that they do not become slivers (M.-C. Rivara, "New
/// longest-edge algorithms for the refinement and/or improvement of unstructured triangulations",
/// 1997).
TriangleData split_convex_edges(TriangleData surface, Real longest);

}  // namespace sutura::contact
