#include "near_triangles.h"

#include <algorithm>

namespace sutura::contact {
namespace {

constexpr Real further = 0.25;  // in units of the mean edge, beyond what is asked

}  // namespace

void NearTriangles::look(const MovingSurface& nodes, const MovingSurface& faces, Real reach) {
  const Real room = further * std::min(nodes.edge_length(), faces.edge_length());
  if (reach <= reach_ && nodes_.moved(nodes) + faces_.moved(faces) <= room) return;
  reach_ = reach;
  nodes_.set(nodes);
  faces_.set(faces);
  list(nodes, faces, reach + room);
}

void NearTriangles::list(const MovingSurface& nodes, const MovingSurface& faces, Real reach) {
  const bool is_self = &nodes == &faces;
  triangles_.clear();
  first_.assign(1, 0);
  for (const MovingSurface::SurfaceNode& n : nodes.surface_nodes()) {
    Box way;
    way.add(nodes.point(n.node)), way.add(nodes.point(n.node) - nodes.moved(n.node));
    faces.near(way.grown(reach), [&](Index t) {
      const auto& corners = faces.nodes(t);
      if (!is_self || std::find(corners.begin(), corners.end(), n.node) == corners.end())
        triangles_.push_back(t);
    });
    std::sort(triangles_.begin() + static_cast<std::ptrdiff_t>(first_.back()), triangles_.end());
    first_.push_back(triangles_.size());
  }
}

}  // namespace sutura::contact
