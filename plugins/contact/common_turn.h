// How two strands that touch turn as one.
#pragma once

#include <algorithm>
#include <cmath>

#include "sutura/types.h"

namespace sutura::contact {

/// The turn of two sections a and b from where they were (a0, b0), whatever each has rolled about
/// its tangent: exact for a rigid motion of both. Their tangents tell, and the line from one centre
/// to the other, as far as the two touched at the start: were about `reach` apart (m).
inline Quat common_turn(const Pose& a0, const Pose& a, const Pose& b0, const Pose& b, Real reach) {
  const auto tangent = [](const Pose& p) { return Vec3(p.rotation * Vec3::UnitX()); };
  const Vec3 ta0 = tangent(a0), ta = tangent(a), tb0 = tangent(b0), tb = tangent(b);
  const Real side = ta0.dot(tb0) < 0 ? -1 : 1;
  // What is half way between the tangents is turned the shortest way; and then about that, so that
  // the rest meets as well as it can.
  const Vec3 middle = (ta + side * tb).normalized();
  const Quat tilt = shortest_rotation((ta0 + side * tb0).normalized(), middle);
  Real cosine = 0, sine = 0;
  const auto meet = [&](const Vec3& from, const Vec3& to) {
    const Vec3 tilted = tilt * from;
    cosine += tilted.dot(to) - tilted.dot(middle) * to.dot(middle);
    sine += middle.dot(tilted.cross(to));
  };
  meet(ta0 - side * tb0, ta - side * tb);
  const Vec3 line = (a0.position - b0.position) / reach;
  meet(line, (a.position - b.position) / reach);
  // From a tenth of `reach` between the surfaces on, the line says little.
  const Real apart = 10 * std::max(Real(0), (line - ta0.dot(line) * ta0).norm() - 1);
  cosine += apart * apart;
  return Quat(Eigen::AngleAxis<Real>(std::atan2(sine, cosine), middle)) * tilt;
}

}  // namespace sutura::contact
