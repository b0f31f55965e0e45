// Puncture: a tip presses on a surface until the force that the surface can bear.
//
// Three rows in world axes: delta (m) is the displacement of the tip relative to the tissue point
// over the step, lambda (N) the force on the tip. n: unit normal on the side where the tip is,
// t: unit axis of the shaft, pointing where the tip advances (t . n < 0), gap (m): distance of the
// tip from the surface at the start of the step.
//
//   before:  0 <= n.delta + gap  _|_  lambda_n in [0, fp]        (yields, n.delta + gap < 0, at fp)
//            tangent plane: Coulomb with mu, |lambda_t| <= mu lambda_n
//   event:   lambda_n = fp and n.delta + gap < 0: the surface gives way; mode becomes penetrated
//   after:   across t: delta = 0 (the shaft is held by the hole)
//            along t: lambda = -r t, r in [0, fc]: r = fc while the tip advances beyond the surface,
//            0 while it retracts
//
// The way out of a tissue is the same law seen from inside: the source passes the reversed outward
// normal (the side where the tip is), mu of the inside (usually 0), and fc = 0 because nothing is
// left to be cut in front of the tip. fp of entry and exit may differ.
//
// The rows stay in one fixed basis, so the law can change its directions inside a solve. Source: the
// paper's puncture section; algorithms.md B.6.
#pragma once

#include "sutura/laws/coulomb.h"

namespace sutura {

struct PunctureLaw {
  static constexpr int dim = 3;
  static constexpr const char* name = "puncture";
  struct Params {
    Vec3 normal = Vec3::UnitZ();
    Vec3 axis = -Vec3::UnitZ();
    Real fp = 0;   ///< N
    Real fc = 0;   ///< N
    Real mu = 0;
    Real gap = 0;  ///< m
  };

  /// Before the event: the states of Friction. After: how the tip moves along its axis.
  static constexpr Mode free = static_cast<Mode>(Friction::open);
  static constexpr Mode penetrated = 8;          ///< held along the axis too, r in (0, fc)
  static constexpr Mode penetrated_cutting = 9;  ///< r = fc
  static constexpr Mode penetrated_loose = 10;   ///< r = 0
  static bool is_penetrated(Mode mode) { return mode >= penetrated; }

  static void project(const Mat3& W, const Vec3& d, const Params& p, Mode& mode, Vec3& lambda) {
    if (is_penetrated(mode)) {
      project_penetrated(W, d, p, mode, lambda);
      return;
    }
    const Mat3 R = frame(p.normal);
    Vec3 local = R.transpose() * d;
    local[0] += p.gap;
    Vec3 force;
    mode = static_cast<Mode>(solve_friction(R.transpose() * W * R, local, p.mu, p.fp, force));
    lambda = R * force;
  }

  static void free_directions(const Vec3& delta, const Params& p, Mode mode, const Vec3& lambda,
                              FreeDirections<3>& out) {
    const Mat3 R = frame(is_penetrated(mode) ? p.axis : p.normal);
    if (is_penetrated(mode)) {
      // Columns: across, across, along; the last only while it neither cuts nor slides out.
      out.move << R.col(1), R.col(2), R.col(0);
      out.test = out.move;
      out.count = mode == penetrated ? 3 : 2;
      out.gap[2] = -surface_along_axis(p);
      return;
    }
    FreeDirections<3> local;
    friction_directions(R.transpose() * delta, p.mu, 0, static_cast<Friction>(mode),
                        R.transpose() * lambda, local);
    out.count = local.count;
    out.move = R * local.move;
    out.test = R * local.test;
    out.gap = local.gap;
    out.compliance = local.compliance;
    for (int j = 0; j < out.count; ++j) out.gap[j] += p.gap * local.test(0, j);
  }

  static bool event(const Params& p, const Vec3& delta, Mode& mode, const Vec3&) {
    const auto state = static_cast<Friction>(mode);
    if (is_penetrated(mode)) return false;
    if (state != Friction::capped_stick && state != Friction::capped_slip) return false;
    if (!(p.normal.dot(delta) + p.gap < 0)) return false;
    mode = penetrated;
    return true;
  }

 private:
  static Mat3 frame(const Vec3& first) {
    Mat3 R;
    R << first, perpendicular_basis<3>(first);
    return R;
  }
  /// How far the tip may advance along its axis before it is in the surface (m).
  static Real surface_along_axis(const Params& p) {
    return std::max(p.gap, Real(0)) / std::max(-p.axis.dot(p.normal), Real(0.1));
  }

  static void project_penetrated(const Mat3& W, const Vec3& d, const Params& p, Mode& mode,
                                 Vec3& lambda) {
    const Mat3 R = frame(p.axis);
    const Mat3 A = R.transpose() * W * R;
    Vec3 local = R.transpose() * d;
    local[0] -= surface_along_axis(p);
    // r is a clamp on the axial row with the lateral rows eliminated: their share is exact.
    const BlockMatrix<2> lateral = A.block<2, 2>(1, 1);
    const Vec2 coupling = A.block<2, 1>(1, 0);
    const BlockMatrix<2> inverse = lateral.inverse();
    const Real w = A(0, 0) - coupling.dot(inverse * coupling);
    const Real free_advance = local[0] - coupling.dot(inverse * local.tail<2>());
    Vec3 force;
    const Real r = free_advance / w;
    mode = r <= 0 ? penetrated_loose : r >= p.fc ? penetrated_cutting : penetrated;
    force[0] = -std::clamp(r, Real(0), p.fc);
    force.tail<2>() = -inverse * (local.tail<2>() + coupling * force[0]);
    lambda = R * force;
  }
};

}  // namespace sutura
