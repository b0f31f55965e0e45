// Puncture: a tip presses on a surface until the force that the surface can bear.
//
// Three rows in world axes: delta (m) = tip minus surface point, lambda (N) = force on the tip. n:
// unit normal on the side where the tip is, t: unit axis of the shaft, pointing where the tip
// advances (t . n < 0). With lambda_n = n . lambda and the tangent plane across n:
//
//   pressing:    0 <= g  _|_  lambda_n >= 0   while lambda_n < fp;   g <= 0 at lambda_n = fp
//                with g = n.delta + c lambda_n, c the compliance of the contact
//                Coulomb with mu in the tangent plane, |lambda_t| <= mu lambda_n
//   event:       lambda_n = fp ("yielding") and g < 0: the surface gives way, for good; fires once
//                the end of the step has been measured
//   penetrated:  across t: delta = 0 (the hole holds the shaft)
//                along t: lambda = -r t, 0 <= r <= fc + k a: the upper limit while the tip is ahead
//                of the surface point by a = t.delta > 0, 0 while it is behind. k (N/m) is the
//                friction on the shaft per length: what slips in during this step drags at once, so
//                that the force after the puncture does not depend on the step
//
// The way out is the same law seen from inside: the source passes the reversed outward normal (the
// side where the tip is), the threshold of the exit, fc = 0, because nothing is left to be cut in
// front of the tip, and no hold, because the channel behind the tip holds the shaft already. A
// layer under another one is an entry whose normal is the axis of the needle.
//
// The rows stay in one fixed basis, so that the law can change its directions inside a solve.
// Source: "Interactive simulation of surgical suturing" (anonymous draft), section 4.2.
#pragma once

#include <algorithm>

#include "sutura/laws/coulomb.h"

namespace sutura::suturing {

struct PunctureLaw {
  static constexpr int dim = 3;
  static constexpr const char* name = "puncture";
  struct Params {
    Vec3 normal = Vec3::UnitZ();
    Vec3 axis = -Vec3::UnitZ();
    Real puncture_force = 0;  ///< fp, N
    Real cutting_force = 0;   ///< fc, N
    Real friction = 0;        ///< mu
    Real compliance = 0;      ///< c, m/N
    Real drag = 0;            ///< k, N/m
    bool hold = true;         ///< whether the hole holds the shaft once through
  };
  static constexpr Mode pressing = 0;
  static constexpr Mode penetrated = 1;
  static constexpr Mode yielding = 2;  ///< pressing, at the threshold

  static void project(const Mat3& W, const Vec3& d, const Params& p, Mode& mode, Vec3& lambda) {
    const Mat3 R = frame(mode == penetrated ? p.axis : p.normal);
    Mat3 A = R.transpose() * W * R;
    if (mode != penetrated) A(0, 0) += p.compliance;
    const Vec3 local = R.transpose() * d;
    Vec3 force;
    if (mode == penetrated) {
      project_penetrated(A, local, p, force);
    } else {
      const Friction state = solve_friction(A, local, p.friction, p.puncture_force, force);
      const bool yields = state == Friction::capped_stick || state == Friction::capped_slip;
      mode = yields ? yielding : pressing;
    }
    lambda = R * force;
  }

  static void free_directions(const Vec3& delta, const Params& p, Mode mode, const Vec3& lambda,
                              FreeDirections<3>& out) {
    const Mat3 R = frame(mode == penetrated ? p.axis : p.normal);
    const Vec3 force = R.transpose() * lambda;
    if (mode == penetrated) {
      // Across, across, along; the last unless it cuts against a constant force or slides out.
      out.move << R.col(1), R.col(2), R.col(0);
      out.test = out.move;
      out.count = 2;
      const bool stopped = force[0] < 0 && below(-force[0], p.cutting_force);
      if (stopped) {
        out.count = 3;
      } else if (force[0] < 0 && p.drag > 0) {
        // r = fc + k a: a spring about the level.
        out.count = 3;
        out.gap[2] = (force[0] + p.cutting_force) / p.drag;
        out.compliance(2, 2) = 1 / p.drag;
      }
      if (!p.hold) keep_axial(out);
      return;
    }
    FreeDirections<3> local;
    friction_directions(R.transpose() * delta, p.friction, p.compliance,
                        friction_state(force, p.friction, p.puncture_force), force, local);
    out = local;
    out.move = R * local.move;
    out.test = R * local.test;
  }

  /// lambda was at the threshold along the normal for which it was found. That may have turned, so
  /// only the size of lambda is asked, for the tip may press on another surface by now.
  static bool event(const Params& p, const Vec3& delta, Mode& mode, const Vec3& lambda) {
    constexpr Real nearly = 1 - 2e-4;  // the next guess may mix the forces of the last passes
    if (mode != yielding || lambda.norm() < nearly * p.puncture_force) return false;
    if (!(p.normal.dot(delta) + p.compliance * p.puncture_force < 0)) return false;
    mode = penetrated;
    return true;
  }

 private:
  /// x < limit, where a value clamped to the limit and rotated since then is not below it.
  static bool below(Real x, Real limit) { return x < limit * (1 - 1e-12); }

  static Mat3 frame(const Vec3& first) {
    Mat3 R;
    R << first, perpendicular_basis<3>(first);
    return R;
  }

  /// Drops the two directions across the axis.
  static void keep_axial(FreeDirections<3>& out) {
    out.count -= 2;
    out.move.col(0) = out.move.col(2);
    out.test = out.move;
    out.gap[0] = out.gap[2];
    out.compliance(0, 0) = out.compliance(2, 2);
  }

  /// Rows: along the axis, across, across.
  static void project_penetrated(const Mat3& A, const Vec3& d, const Params& p, Vec3& force) {
    // The axial row with the lateral rows eliminated is a clamp of its own: one pass is exact.
    const BlockMatrix<2> inverse =
        p.hold ? BlockMatrix<2>(A.block<2, 2>(1, 1).inverse()) : BlockMatrix<2>::Zero();
    const Vec2 coupling = A.block<2, 1>(1, 0);
    const Real w = A(0, 0) - coupling.dot(inverse * coupling);
    const Real advance = d[0] - coupling.dot(inverse * d.tail<2>());
    const Real blocked = std::max(advance / w, Real(0));
    force[0] = blocked <= p.cutting_force
                   ? -blocked
                   : -(p.cutting_force + p.drag * advance) / (1 + p.drag * w);
    force.tail<2>() = -inverse * (d.tail<2>() + coupling * force[0]);
  }
};

}  // namespace sutura::suturing
