// How far a surface has moved since it was marked: what was found then still bounds what there is.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "moving_surface.h"

namespace sutura::contact {

class SurfaceMark {
 public:
  void set(const MovingSurface& surface) {
    at_.clear();
    for (const MovingSurface::SurfaceNode& n : surface.surface_nodes())
      at_.push_back(surface.point(n.node));
  }
  /// The largest way of a node from there to where it starts the step or is now; infinite if the
  /// surface was never marked (m).
  Real moved(const MovingSurface& surface) const {
    const auto& nodes = surface.surface_nodes();
    if (at_.size() != nodes.size()) return std::numeric_limits<Real>::infinity();
    Real most = 0;
    for (std::size_t k = 0; k < at_.size(); ++k) {
      const Vec3 now = surface.point(nodes[k].node), start = now - surface.moved(nodes[k].node);
      most = std::max({most, (now - at_[k]).squaredNorm(), (start - at_[k]).squaredNorm()});
    }
    return std::sqrt(most);
  }

 private:
  std::vector<Vec3> at_;  ///< by surface node (m)
};

}  // namespace sutura::contact
