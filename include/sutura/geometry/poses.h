// Rigid placements: applying, undoing and joining them.
#pragma once

#include "sutura/types.h"

namespace sutura {

inline Vec3 at(const Pose& pose, const Vec3& local) {
  return pose.position + pose.rotation * local;
}
inline Vec3 seen_from(const Pose& pose, const Vec3& world) {
  return pose.rotation.conjugate() * (world - pose.position);
}
/// First `b`, then `a`.
inline Pose compose(const Pose& a, const Pose& b) {
  return {at(a, b.position), (a.rotation * b.rotation).normalized()};
}

}  // namespace sutura
