// The centreline of one beam: the cubic through its nodes with the section tangents, at the speed
// of the arc length. The mass matrix and the weight integrate this very curve.
#pragma once

#include <array>

#include "sutura/types.h"

namespace sutura::thread {

struct Cubic {
  Vec3 xa, ma, xb, mb;  ///< ends, and tangents times the length of the beam

  Cubic(const Pose& a, const Pose& b, Real length)
      : xa(a.position),
        ma(length * (a.rotation * Vec3::UnitX())),
        xb(b.position),
        mb(length * (b.rotation * Vec3::UnitX())) {}

  /// Hermite weights of (xa, ma, xb, mb) at u in [0, 1].
  static std::array<Real, 4> weights(Real u) {
    const Real v = 1 - u;
    return {v * v * (1 + 2 * u), u * v * v, u * u * (3 - 2 * u), -u * u * v};
  }
  static std::array<Real, 4> weight_slopes(Real u) {
    const Real v = 1 - u;
    return {-6 * u * v, v * (1 - 3 * u), 6 * u * v, u * (3 * u - 2)};
  }
  Vec3 point(Real u) const { return combine(weights(u)); }
  /// d point / du
  Vec3 slope(Real u) const { return combine(weight_slopes(u)); }
  /// d2 point / du2
  Vec3 second(Real u) const { return combine({12 * u - 6, 6 * u - 4, 6 - 12 * u, 6 * u - 2}); }

 private:
  Vec3 combine(const std::array<Real, 4>& w) const {
    return w[0] * xa + w[1] * ma + w[2] * xb + w[3] * mb;
  }
};

}  // namespace sutura::thread
