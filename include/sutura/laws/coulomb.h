// Coulomb: contact with dry friction. Rows: normal, tangent 1, tangent 2.
//
//   0 <= delta_n + c lambda_n  _|_  lambda_n >= 0
//   |lambda_t| <= mu lambda_n;  if delta_t != 0:  lambda_t = -mu lambda_n delta_t / |delta_t|
//
// delta_n (m) gap, delta_t (m) slip over the step, lambda (N), c (m/N) compliance of the contact
// along its normal. The slip opposes the tangential displacement itself (no dilatancy term, unlike
// associated friction).
//
// One block is solved exactly. Slip means delta_t = -k lambda_t with k >= 0 (m/N), so lambda(k) is
// the solution of a linear system and k a root of |lambda_t(k)| - mu lambda_n(k), which is positive
// at k = 0 (stick is not admissible) and negative for large k (only the normal force is left).
#pragma once

#include <limits>

#include "sutura/laws/ball.h"

namespace sutura {

enum class Friction : Mode { open, stick, slip, capped_stick, capped_slip };

namespace detail {

/// Uncapped contact that is closed (d_n < 0) and whose sticking force is not admissible.
inline void solve_slip(const Mat3& W, const Vec3& d, Real mu, Vec3& lambda) {
  // Normal row eliminated: (S + k) lambda_t = -r, lambda_n = -(d_n + w . lambda_t) / W_nn.
  const Real wn = W(0, 0);
  const Vec2 w = W.block<2, 1>(1, 0);
  const BlockMatrix<2> S = W.block<2, 2>(1, 1) - w * w.transpose() / wn;
  const Vec2 r = d.tail<2>() - w * (d[0] / wn);
  Eigen::SelfAdjointEigenSolver<BlockMatrix<2>> eigen;
  eigen.computeDirect(S);
  const Vec2 e = eigen.eigenvalues().cwiseMax(0);
  const Vec2 re = eigen.eigenvectors().transpose() * r;
  const Vec2 we = eigen.eigenvectors().transpose() * w;
  Vec2 t;
  Real n = 0;
  const auto excess = [&](Real k) {
    for (int i = 0; i < 2; ++i) t[i] = e[i] + k > 0 ? -re[i] / (e[i] + k) : Real(0);
    n = -(d[0] + we.dot(t)) / wn;
    return t.norm() - mu * n;
  };
  Real low = 0, high = std::max(e[1], Real(1e-12) * wn);
  Real f_low = excess(0), f_high = excess(high);
  for (int i = 0; f_high > 0 && i < 200; ++i) {
    low = high;
    f_low = f_high;
    high *= 4;
    f_high = excess(high);
  }
  // Illinois false position, with a bisection every fourth step against slow cases.
  int side = 0;
  for (int i = 0; i < 200 && high - low > 4e-16 * high; ++i) {
    const Real k = i % 4 == 3 || !(f_low > f_high)
                       ? 0.5 * (low + high)
                       : (low * f_high - high * f_low) / (f_high - f_low);
    const Real f = excess(k);
    if (f > 0) {
      low = k;
      f_low = f;
      if (side == 1) f_high *= 0.5;
      side = 1;
    } else {
      high = k;
      f_high = f;
      if (side == -1) f_low *= 0.5;
      side = -1;
    }
    if (f == 0) break;
  }
  excess(high);
  n = std::max(n, Real(0));
  const Real norm = t.norm();
  if (norm > 0) t *= mu * n / norm;  // on the cone, to the last bit
  lambda[0] = n;
  lambda.tail<2>() = eigen.eigenvectors() * t;
}

}  // namespace detail

/// One contact with friction and a normal force of at most `cap`: beyond, delta_n <= 0 yields.
inline Friction solve_friction(const Mat3& W, const Vec3& d, Real mu, Real cap, Vec3& lambda) {
  if (!(d[0] < 0) || !(W(0, 0) > 0)) {
    lambda.setZero();
    return Friction::open;
  }
  if (mu <= 0) {
    lambda << std::min(-d[0] / W(0, 0), cap), 0, 0;
    return lambda[0] < cap ? Friction::slip : Friction::capped_slip;
  }
  Friction state = Friction::slip;
  const Eigen::LLT<Mat3> factor(W);
  bool sticks = false;
  if (factor.info() == Eigen::Success) {
    const Vec3 stick = -factor.solve(d);
    if (stick[0] >= 0 && stick.tail<2>().norm() <= mu * stick[0]) {
      lambda = stick;
      state = Friction::stick;
      sticks = true;
    }
  }
  if (!sticks) detail::solve_slip(W, d, mu, lambda);
  if (lambda[0] <= cap) return state;

  // Normal force n given: the tangent rows are a ball of radius mu n.
  const Mat3& A = W;
  Real s = 0;
  const auto normal_gap = [&](Real n) {
    Vec2 t;
    s = solve_in_ball<2>(A.block<2, 2>(1, 1), d.tail<2>() + A.block<2, 1>(1, 0) * n, mu * n, t);
    lambda << n, t;
    return d[0] + A(0, 0) * n + A(0, 1) * t[0] + A(0, 2) * t[1];
  };
  if (normal_gap(cap) <= 0) return s > 0 ? Friction::capped_slip : Friction::capped_stick;
  // Strong coupling of normal and tangent: another solution lies below the cap.
  Real low = 0, high = cap;
  for (int i = 0; i < 100 && high - low > 4e-16 * high; ++i) {
    const Real n = 0.5 * (low + high);
    (normal_gap(n) < 0 ? low : high) = n;
  }
  normal_gap(high);
  return s > 0 ? Friction::slip : Friction::stick;
}

/// The state that a force on the friction law's graph belongs to. Projection puts limits exactly; a
/// force that was rotated since then is still taken for one at its limit.
inline Friction friction_state(const Vec3& lambda, Real mu, Real cap) {
  constexpr Real nearly = 1 - 1e-12;
  if (!(lambda[0] > 0)) return Friction::open;
  const bool slips = lambda.tail<2>().norm() >= mu * lambda[0] * nearly;
  if (lambda[0] >= cap * nearly) return slips ? Friction::capped_slip : Friction::capped_stick;
  return slips ? Friction::slip : Friction::stick;
}

/// Tangent of the friction law at (delta, lambda); compliance along the normal.
inline void friction_directions(const Vec3& delta, Real mu, Real compliance, Friction state,
                                const Vec3& lambda, FreeDirections<3>& free) {
  free.count = 0;
  const auto add = [&](const Vec3& move, const Vec3& test, Real gap, Real c) {
    free.move.col(free.count) = move;
    free.test.col(free.count) = test;
    free.gap[free.count] = gap;
    free.compliance(free.count, free.count) = c;
    ++free.count;
  };
  const bool normal = state == Friction::stick || state == Friction::slip;
  const bool sticks = state == Friction::stick || state == Friction::capped_stick;
  const Real norm = lambda.tail<2>().norm();
  Vec3 along = Vec3::UnitX();
  if (!sticks && norm > 0) along.tail<2>() = lambda.tail<2>() * (mu / norm);
  if (normal) add(along, Vec3::UnitX(), compliance * lambda[0], compliance);
  if (state == Friction::open) return;
  if (sticks) {
    add(Vec3::UnitY(), Vec3::UnitY(), 0, 0);
    add(Vec3::UnitZ(), Vec3::UnitZ(), 0, 0);
  } else if (norm > 0) {
    // The slip may turn: perpendicular to it delta = -k lambda, k = |delta_t| / |lambda_t|.
    const Vec3 turn(0, -lambda[2] / norm, lambda[1] / norm);
    add(turn, turn, 0, delta.tail<2>().norm() / norm);
  }
}

struct Coulomb {
  static constexpr int dim = 3;
  static constexpr const char* name = "coulomb";
  struct Params {
    Real mu = 0;          ///< friction coefficient
    Real compliance = 0;  ///< c, m/N
  };

  static void project(const Mat3& W, const Vec3& d, const Params& p, Mode& mode, Vec3& lambda) {
    Mat3 total = W;
    total(0, 0) += p.compliance;
    mode = static_cast<Mode>(
        solve_friction(total, d, p.mu, std::numeric_limits<Real>::infinity(), lambda));
  }
  static void free_directions(const Vec3& delta, const Params& p, Mode mode, const Vec3& lambda,
                              FreeDirections<3>& free) {
    friction_directions(delta, p.mu, p.compliance, static_cast<Friction>(mode), lambda, free);
  }
};

}  // namespace sutura
