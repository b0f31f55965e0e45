#include "chain_motion.h"

#include <algorithm>
#include <cmath>

namespace sutura::thread {

Quat rotated(const Quat& q, const Vec3& spin) {
  const Real a2 = spin.squaredNorm();
  Real c, s;  // cos(a/2), sin(a/2)/a
  if (a2 < 1e-4) {
    c = 1 - a2 / 8 + a2 * a2 / 384;
    s = 0.5 - a2 / 48 + a2 * a2 / 3840;
  } else {
    const Real a = std::sqrt(a2);
    c = std::cos(a / 2);
    s = std::sin(a / 2) / a;
  }
  const Vec3 v = s * spin;
  return (Quat(c, v.x(), v.y(), v.z()) * q).normalized();
}

Quat turned(const Quat& q, const Vec3& turn) {
  const Vec3 along = q * Vec3::UnitX();
  const Real roll = turn.dot(along);
  return rotated(rotated(q, roll * along), turn - roll * along);
}

Vec3 as_change_of_turn(const Vec3& turn, const Vec3& from, const Vec3& to, const Vec3& spin) {
  const Vec3 tilt = turn - turn.dot(from) * from;
  const Real angle = tilt.norm();
  if (angle < 1e-9) return spin;
  const Vec3 axis = tilt / angle, across = axis.cross(to);
  const Real aside = spin.dot(across);
  return spin.dot(axis) * axis + angle / std::sin(angle) * aside * axis.cross(from) +
         (spin.dot(to) - std::tan(angle / 2) * aside) * from;
}

Vec3 rotation_between(const Quat& from, const Quat& to) {
  Quat d = to * from.conjugate();
  if (d.w() < 0) d.coeffs() = -d.coeffs();
  const Real sine = d.vec().norm();
  if (sine < 1e-9) return 2 * d.vec();
  return d.vec() * (2 * std::atan2(sine, d.w()) / sine);
}

void move_chain(const std::vector<Pose>& from, const std::vector<Real>& twist_from,
                const Dofs& motion, std::vector<Pose>& to, std::vector<Real>& twist_to) {
  const auto nodes = static_cast<Index>(from.size());
  for (Index e = 0; e + 1 < nodes; ++e) {
    const Vec3 span = from[e + 1].position - from[e].position;
    const Vec3 spin = motion.segment<3>(6 * e + 9) - motion.segment<3>(6 * e + 3);
    twist_to[e] = twist_from[e] + span.dot(spin) / span.norm();
  }
  for (Index i = 0; i < nodes; ++i) {
    to[i].position = from[i].position + motion.segment<3>(6 * i);
    to[i].rotation = turned(from[i].rotation, motion.segment<3>(6 * i + 3));
  }
}

}  // namespace sutura::thread
