#include "held_triangles.h"

#include <algorithm>
#include <limits>

namespace sutura::contact {
namespace {

// In units of the mean edge of the tissue, as for tools that are no meshes (surface_tool.cpp).
constexpr Real dip = 0.01;   // what is so much nearer than the corners is not held by them
constexpr Real cut = 0.05;   // what a rim may cut into a triangle beside one that a side lies on
constexpr Real stays = 0.5;  // of that, a touch that there was stays

}  // namespace

void HeldTriangles::look(const MovingSurface& tissue, std::span<const Touch> touches) {
  edge_ = tissue.edge_length();
  const std::size_t nodes = static_cast<std::size_t>(tissue.surface_nodes().back().node) + 1;
  gap_.assign(nodes, std::numeric_limits<Real>::infinity());
  lies_.assign(nodes, 0);
  for (const Touch& t : touches) {
    Real& gap = gap_[static_cast<std::size_t>(t.node)];
    gap = std::min(gap, t.gap);
  }
  for (Index t = 0; t < tissue.triangles(); ++t) {
    const auto& corners = tissue.nodes(t);
    if (std::all_of(corners.begin(), corners.end(),
                    [&](Index n) { return gap_[static_cast<std::size_t>(n)] <= dip * edge_; }))
      for (const Index n : corners) lies_[static_cast<std::size_t>(n)] = 1;
  }
}

bool HeldTriangles::hold(const std::array<Index, 3>& corners, Real height, bool was_touched) const {
  Real at_corners = std::numeric_limits<Real>::infinity();
  bool lies_beside = false;
  for (const Index n : corners) {
    at_corners = std::min(at_corners, gap_[static_cast<std::size_t>(n)]);
    lies_beside = lies_beside || lies_[static_cast<std::size_t>(n)] != 0;
  }
  // The rim of a side always cuts a little into the triangles around it: held there, a punch would
  // press wider than it is. What has had a touch is let go later, else it would come and go.
  const Real in = (was_touched ? stays : 1) * cut * edge_;
  if (lies_beside && height >= std::min(Real(0), at_corners) - in) return true;
  return !was_touched && height >= at_corners - dip * edge_;
}

}  // namespace sutura::contact
