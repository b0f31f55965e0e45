#include "surface_edges.h"

#include <algorithm>
#include <tuple>

namespace sutura::contact {
namespace {

// Cosine between the sides of an edge that stands out: 18 degrees or more. Flatter ones are seen by
// the nodes around.
constexpr Real flat = 0.95;

}  // namespace

void SurfaceEdges::learn(const MovingSurface& surface) {
  known_ = true;
  struct Side {
    Index low, high, triangle, from, to;
  };
  std::vector<Side> sides;
  for (Index t = 0; t < surface.triangles(); ++t)
    for (Index k = 0; k < 3; ++k) {
      const auto& nodes = surface.nodes(t);
      const Index next = (k + 1) % 3;
      const Index a = nodes[static_cast<std::size_t>(k)], b = nodes[static_cast<std::size_t>(next)];
      sides.push_back({std::min(a, b), std::max(a, b), t, a < b ? k : next, a < b ? next : k});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high)
      ++end;
    if (end == i + 2) {  // where two parts meet in an edge only, it has four sides, and is left out
      Index opposite = 0;
      for (const Index node : surface.nodes(sides[i + 1].triangle))
        if (node != sides[i].low && node != sides[i].high) opposite = node;
      edges_.push_back({{sides[i].low, sides[i].high},
                        {sides[i].triangle, sides[i + 1].triangle},
                        {sides[i].from, sides[i].to},
                        opposite});
    }
    i = end;
  }
}

Segment SurfaceEdges::at(const MovingSurface& surface, const Edge& edge, Real time) {
  const Corners c = surface.at(edge.triangle[0], time);
  return {c[static_cast<std::size_t>(edge.corner[0])], c[static_cast<std::size_t>(edge.corner[1])]};
}

void SurfaceEdges::look(const MovingSurface& surface, const SurfaceNormals& normals) {
  sides_.resize(edges_.size());
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const Edge& e = edges_[i];
    for (const When when : {start, now}) {
      const auto normal = [&](Index t) {
        return when == now ? normals.now(t) : normals.at_start(t);
      };
      Sides& s = sides_[i][when];
      s = {normal(e.triangle[0]), normal(e.triangle[1]), false};
      if (!(s.first.dot(s.second) < flat)) continue;
      // The corner of the second side that is not on the edge lies below the plane of the first.
      Vec3 across = surface.point(e.opposite) - surface.point(e.node[0]);
      if (when == start) across -= surface.moved(e.opposite) - surface.moved(e.node[0]);
      s.is_ridge = s.first.dot(across) < 0;
    }
  }
}

Vec3 SurfaceEdges::outward(Index edge, When when) const {
  const Sides& s = sides_[static_cast<std::size_t>(edge)][when];
  return s.is_ridge ? Vec3(s.first + s.second) : Vec3(Vec3::Zero());
}

/// A direction across the edge is between the normals of its sides if each of these is turned
/// towards it by no more than towards the other.
bool SurfaceEdges::faces(Index edge, const Vec3& direction, When when) const {
  // Where a flat side lies on another one, the direction is its normal.
  constexpr Real rounding = 1e-3;
  const Sides& s = sides_[static_cast<std::size_t>(edge)][when];
  if (!s.is_ridge) return false;
  const Vec3 turn = s.first.cross(s.second);
  return s.first.cross(direction).dot(turn) > -rounding &&
         direction.cross(s.second).dot(turn) > -rounding && direction.dot(s.first + s.second) > 0;
}

}  // namespace sutura::contact
