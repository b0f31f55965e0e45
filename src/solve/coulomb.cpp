#include "sutura/laws/coulomb.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sutura {

namespace {

/// Uncapped contact that is closed (d_n < 0) and whose sticking force is not admissible.
void solve_slip(const Mat3& W, const Vec3& d, Real mu, Vec3& lambda) {
  // Normal row eliminated: (S + k) lambda_t = -r, lambda_n = -(d_n + w . lambda_t) / W_nn.
  const Real wn = W(0, 0);
  const Vec2 w = W.block<2, 1>(1, 0);
  const BlockMatrix<2> S = W.block<2, 2>(1, 1) - w * w.transpose() / wn;
  const Vec2 r = d.tail<2>() - w * (d[0] / wn);
  Vec2 e = S.diagonal().cwiseMax(0);
  BlockMatrix<2> axes = BlockMatrix<2>::Identity();
  if (S(1, 0) != 0) {  // laws are most often asked with a diagonal
    Eigen::SelfAdjointEigenSolver<BlockMatrix<2>> eigen;
    eigen.computeDirect(S);
    e = eigen.eigenvalues().cwiseMax(0);
    axes = eigen.eigenvectors();
  }
  const Vec2 re = axes.transpose() * r, we = axes.transpose() * w;
  Vec2 t;
  Real n = 0, slope = 0;  // of the excess over k
  const auto excess = [&](Real k) {
    Vec2 dt = Vec2::Zero();
    for (int i = 0; i < 2; ++i) {
      t[i] = e[i] + k > 0 ? -re[i] / (e[i] + k) : Real(0);
      if (e[i] + k > 0) dt[i] = -t[i] / (e[i] + k);
    }
    n = -(d[0] + we.dot(t)) / wn;
    const Real norm = t.norm();
    slope = (norm > 0 ? t.dot(dt) / norm : Real(0)) + mu * we.dot(dt) / wn;
    return norm - mu * n;
  };
  // Newton's method, and a bisection where it leaves what encloses the root or is slow. It begins
  // from the root for a W that is alike in both tangents and does not couple them to the normal.
  const Real mean = re.squaredNorm() > 0 ? re.cwiseAbs2().dot(e) / re.squaredNorm() : Real(0);
  const Real guess = re.norm() / (-mu * d[0] / wn) - mean;
  constexpr Real rounding = 4e-16, none = std::numeric_limits<Real>::infinity();
  Real k = guess > 0 && guess < none ? guess : std::max(e.maxCoeff(), Real(1e-12) * wn);
  Real low = 0, high = none, last = 8 * k;
  for (int i = 0; i < 200; ++i) {
    const Real f = excess(k);
    if (f == 0) break;
    (f > 0 ? low : high) = k;
    const Real newton = k - f / slope;
    const bool takes_it = newton > low && newton < high && std::abs(newton - k) < 0.5 * last;
    const Real next = takes_it ? newton : high < none ? 0.5 * (low + high) : 4 * k;
    last = std::abs(next - k);
    if (last <= rounding * k) break;
    k = next;
  }
  n = std::max(n, Real(0));
  const Real norm = t.norm();
  if (norm > 0) t *= mu * n / norm;  // on the cone, to the last bit
  lambda[0] = n;
  lambda.tail<2>() = axes * t;
}

}  // namespace

Friction solve_friction(const Mat3& W, const Vec3& d, Real mu, Real cap, Vec3& lambda) {
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
  if (!sticks) solve_slip(W, d, mu, lambda);
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

Friction friction_state(const Vec3& lambda, Real mu, Real cap) {
  constexpr Real nearly = 1 - 1e-12;
  if (!(lambda[0] > 0)) return Friction::open;
  const bool slips = lambda.tail<2>().norm() >= mu * lambda[0] * nearly;
  if (lambda[0] >= cap * nearly) return slips ? Friction::capped_slip : Friction::capped_stick;
  return slips ? Friction::slip : Friction::stick;
}

void friction_directions(const Vec3& delta, Real mu, Real compliance, Friction state,
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

}  // namespace sutura
