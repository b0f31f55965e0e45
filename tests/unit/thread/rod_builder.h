// Rods for tests: straight along x, or along any curve.
#pragma once

#include <functional>

#include "rod.h"

namespace sutura::thread {

inline RodLayout straight_layout(Real length, Index beams, const Section& section,
                                 const Vec3& direction = Vec3::UnitX()) {
  RodLayout layout;
  const Quat q = shortest_rotation(Vec3::UnitX(), direction);
  for (Index i = 0; i <= beams; ++i) {
    const Real s = length * static_cast<Real>(i) / static_cast<Real>(beams);
    layout.abscissa.push_back(s);
    layout.rest.push_back({s * direction.normalized(), q});
  }
  layout.start = layout.rest;
  layout.sections.assign(static_cast<std::size_t>(beams), section);
  return layout;
}

/// Default thread "N" of the reference sheet: nylon, 0.3 mm.
inline Section nylon() {
  return {.radius = 0.15e-3, .young = 2e9, .poisson = 0.4, .density = 1140};
}

}  // namespace sutura::thread
