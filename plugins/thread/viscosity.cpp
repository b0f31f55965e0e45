#include "viscosity.h"

namespace sutura::thread {

Deformation::Deformation(const ElementState& s, const Pose& a, const Pose& b)
    : strain(s.strain),
      twist(s.twist),
      bend_a(a.rotation.conjugate() * s.theta_a),
      bend_b(b.rotation.conjugate() * s.theta_b) {}

DeformationChange::DeformationChange(const ElementState& s, const Pose& a, const Pose& b,
                                     const Deformation& start)
    : strain(s.strain - start.strain),
      twist(s.twist - start.twist),
      bend_a(s.theta_a - a.rotation * start.bend_a),
      bend_b(s.theta_b - b.rotation * start.bend_b) {}

Real viscous_energy(const ElementRest& r, const DeformationChange& d) {
  return (r.axial * r.length * d.strain * d.strain +
          r.bend_1 * (d.bend_a.squaredNorm() + d.bend_b.squaredNorm()) +
          2 * r.bend_2 * d.bend_a.dot(d.bend_b) + r.torsion * d.twist * d.twist) /
         2;
}

namespace {

/// d (moment . theta) by the chord's direction e, for theta = g(x) e x c with x = 1 - e.c and the
/// section at rest.
Vec3 by_direction(const Vec3& moment, const Vec3& e, const Vec3& c, Real g, Real dg) {
  return g * c.cross(moment) - dg * moment.dot(e.cross(c)) * c;
}

}  // namespace

ElementGradient viscous_gradient(const ElementRest& r, const ElementState& s,
                                 const DeformationChange& d) {
  // A section that turns sees the chord turn the other way.
  const Vec3 moment_a = r.bend_1 * d.bend_a + r.bend_2 * d.bend_b;
  const Vec3 moment_b = r.bend_1 * d.bend_b + r.bend_2 * d.bend_a;
  const Vec3 by_a = by_direction(moment_a, s.e, s.ca, s.ga, s.dga);
  const Vec3 by_b = by_direction(moment_b, s.e, s.cb, s.gb, s.dgb);
  const Vec3 both = by_a + by_b;
  // da.db compares the axes of two sections.
  const Vec3 axes = r.bend_2 * d.bend_a.cross(d.bend_b);
  const Vec3 twist = r.torsion * d.twist * s.twist_axis;
  const Vec9 strain = r.axial * r.length * d.strain * strain_gradient(r, s);
  return {strain.head<3>() + (both - both.dot(s.e) * s.e) / s.l,
          strain.segment<3>(3) - s.e.cross(by_a) + axes - twist,
          strain.tail<3>() - s.e.cross(by_b) - axes + twist};
}

}  // namespace sutura::thread
