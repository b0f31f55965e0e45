#include "edges_through.h"

#include <algorithm>
#include <cmath>

namespace sutura::contact {
namespace {

/// By how much the edge must be shifted, at least, to be clear of the triangle; 0 if it is. All
/// shifts for which the two meet are a prism: the triangle, drawn along the edge.
Real depth(const Segment& edge, const Corners& c, Real least) {
  const Vec3 normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
  const Real before = normal.dot(edge.a - c[0]), behind = normal.dot(edge.b - c[0]);
  if (before * behind >= 0) return 0;
  Real out = std::min(std::abs(before), std::abs(behind));
  const Vec3 along = edge.b - edge.a;
  for (std::size_t i = 0; i < 3 && out > least; ++i) {
    const Vec3 side = c[(i + 1) % 3] - c[i];
    const Vec3 outward = (behind > before ? 1 : -1) * side.cross(along);
    out = std::min(out, outward.dot(c[i] - edge.a) / outward.norm());
  }
  return std::max(out, Real(0));
}

}  // namespace

Real EdgesThrough::deepest(const MovingSurface& edges, const MovingSurface& faces, Real seen) {
  // Where no node has moved by more than d, no depth has grown by more than 2 d.
  if (!(last_ + edges_.moved(edges) + faces_.moved(faces) <= seen)) {
    last_ = search(edges, faces);
    edges_.set(edges);
    faces_.set(faces);
  }
  return last_ > seen ? last_ : 0;
}

Real EdgesThrough::search(const MovingSurface& edges, const MovingSurface& faces) {
  const bool is_self = &edges == &faces;
  Real worst = 0;
  for (Index t = 0; t < edges.triangles(); ++t) {
    const auto& nodes = edges.nodes(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const Index from = nodes[k], to = nodes[(k + 1) % 3];
      if (from > to) continue;  // the triangle beside has it too
      const Segment edge{edges.point(from), edges.point(to)};
      Box box;
      box.add(edge.a), box.add(edge.b);
      faces.near(box, [&](Index other) {
        const auto& corners = faces.nodes(other);
        if (is_self && std::any_of(corners.begin(), corners.end(),
                                   [&](Index node) { return node == from || node == to; }))
          return;
        worst = std::max(worst, depth(edge, faces.now(other), worst));
      });
    }
  }
  return worst;
}

}  // namespace sutura::contact
