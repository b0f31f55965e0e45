#include "needle_pose.h"

namespace sutura::thread {

TipPlace place_by_centre(const NeedleArc& arc, const Vec3& centre, Real tip_angle) {
  TipPlace place;
  if (!(arc.length > 0 && arc.angle > 0)) {
    place.error = "a straight needle has no centre; say 'tip' and 'tip_direction'";
    return place;
  }
  const Vec3 n = arc.normal.normalized();
  const Vec3 down = -Vec3::UnitZ() + n.z() * n;
  if (!(down.norm() > 1e-6)) {
    place.error =
        "the plane of the needle is level, so its arc has no lowest point to count 'tip_angle' "
        "from; say 'plane_normal', 0 -1 0 for instance, or 'tip' and 'tip_direction'";
    return place;
  }
  const Vec3 radial = Eigen::AngleAxis<Real>(tip_angle, n) * down.normalized();
  place.tip = centre + arc.radius() * radial;
  place.direction = n.cross(radial);
  return place;
}

TipPlace place_by_entry(const NeedleArc& arc, const Vec3& entry, const Vec3& direction,
                        Real approach) {
  TipPlace place;
  const Vec3 t = direction.normalized();
  if (!(arc.length > 0 && arc.angle > 0)) {
    place.tip = entry - approach * t;
    place.direction = t;
    return place;
  }
  // The plane gives way to the direction where the two are not at a right angle, as for 'tip'.
  const Vec3 n = (arc.normal - arc.normal.dot(t) * t).normalized();
  const Vec3 radial = t.cross(n);
  const Vec3 centre = entry - arc.radius() * radial;
  const Vec3 back = Eigen::AngleAxis<Real>(-approach / arc.radius(), n) * radial;
  place.tip = centre + arc.radius() * back;
  place.direction = n.cross(back);
  return place;
}

}  // namespace sutura::thread
