#include "suture_shape.h"

#include <algorithm>
#include <cmath>

namespace sutura::thread {

namespace {

/// The pose at distance s along an arc that leaves `from` along its x axis and turns about the unit
/// vector `axis` (normal to x) at `curvature`.
Pose along_arc(const Pose& from, const Vec3& axis, Real curvature, Real s) {
  const Real angle = curvature * s;
  const Vec3 t = from.rotation * Vec3::UnitX(), n = axis.cross(t);
  // Chord and its angle: no division by the curvature.
  const Real half = angle / 2;
  const Real chord = s * (std::abs(half) > 1e-4 ? std::sin(half) / half : 1 - half * half / 6);
  return {from.position + chord * (std::cos(half) * t + std::sin(half) * n),
          Quat(Eigen::AngleAxis<Real>(angle, axis)) * from.rotation};
}

}  // namespace

Pose SutureShape::needle(Real s) const {
  const Vec3 x = -tip_direction.normalized();
  const Vec3 z = (plane_normal - plane_normal.dot(x) * x).normalized();
  Mat3 axes;
  axes << x, z.cross(x), z;
  // Advancing turns by +plane_normal; walking back from the tip turns by minus it.
  return along_arc({tip, Quat(axes)}, -z, needle_length > 0 ? needle_angle / needle_length : 0, s);
}

Pose SutureShape::rest(Real s) const {
  if (s <= needle_length) return needle(s);
  const Pose swage = needle(needle_length);
  return thread_rest.at(swage, s - needle_length);
}

Pose SutureShape::start(Real s) const {
  if (s <= needle_length) return needle(s);
  const Pose swage = needle(needle_length);
  const Real along = s - needle_length;
  if (thread_start) return thread_start->at(swage, along);
  const Vec3 t = swage.rotation * Vec3::UnitX();
  if (thread_direction.isZero()) return along_arc(swage, swage.rotation * Vec3::UnitZ(), 0, along);
  const Vec3 d = thread_direction.normalized();
  Vec3 axis = t.cross(d);
  const Real angle = std::atan2(axis.norm(), t.dot(d));
  axis = axis.norm() > 1e-9 ? axis.normalized() : Vec3(swage.rotation * Vec3::UnitZ());
  const Real bend = std::min(angle * thread_bend_radius, thread_length);
  const Real curvature = bend > 0 ? angle / bend : 0;
  const Pose turned = along_arc(swage, axis, curvature, std::min(along, bend));
  return along_arc(turned, axis, 0, std::max(along - bend, 0.));
}

}  // namespace sutura::thread
