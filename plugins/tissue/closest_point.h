// The point of a triangle closest to p, and whether it lies inside, on an edge or at a corner.
#pragma once

#include <algorithm>
#include <array>

#include "sutura/types.h"

namespace sutura {

struct ClosestPoint {
  Vec3 weights = Vec3::Zero();  ///< barycentric; exactly zero off the feature
  int edge = -1;                ///< 0: corners 0 1, 1: 1 2, 2: 2 0
  int corner = -1;
};

/// Projects on the plane, and if that leaves the triangle, takes the best of the three edges. A
/// flat triangle is its edges.
inline ClosestPoint closest_point(const Vec3& p, const std::array<Vec3, 3>& t) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0], n = u.cross(v);
  const Real area = n.squaredNorm();
  if (area > 0) {
    const Vec3 r = p - t[0];
    const Real w2 = u.cross(r).dot(n) / area, w1 = r.cross(v).dot(n) / area;
    if (w1 > 0 && w2 > 0 && w1 + w2 < 1) return {Vec3(1 - w1 - w2, w1, w2)};
  }
  ClosestPoint best;
  Real least = std::numeric_limits<Real>::infinity();
  for (int e = 0; e < 3; ++e) {
    const Vec3 &a = t[e], &b = t[(e + 1) % 3];
    const Real length = (b - a).squaredNorm();
    const Real s = length > 0 ? std::clamp((p - a).dot(b - a) / length, 0.0, 1.0) : 0;
    const Real distance = (a + s * (b - a) - p).squaredNorm();
    if (!(distance < least)) continue;
    least = distance;
    best = {};
    best.weights[e] = 1 - s;
    best.weights[(e + 1) % 3] = s;
    if (s == 0)
      best.corner = e;
    else if (s == 1)
      best.corner = (e + 1) % 3;
    else
      best.edge = e;
  }
  return best;
}

}  // namespace sutura
