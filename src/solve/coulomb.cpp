#include "sutura/laws/coulomb.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sutura {

namespace {

/// Uncapped contact that is closed (d_n < 0). The normal row is eliminated:
/// (S + k) lambda_t = -r, lambda_n = -(d_n + w . lambda_t) / W_nn.
class ClosedTouch {
 public:
  ClosedTouch(const Mat3& W, const Vec3& d, Real mu)
      : normal_(W(0, 0)),
        gap_(d[0]),
        mu_(mu),
        w_(W.block<2, 1>(1, 0)),
        S_(W.block<2, 2>(1, 1) - w_ * (w_.transpose() / normal_)),
        r_(d.tail<2>() - w_ * (gap_ / normal_)) {}

  /// False if a sticking force is not admissible.
  bool stick(Vec3& lambda) const;
  void slip(Vec3& lambda) const;

 private:
  Real normal_force(const Vec2& t) const { return -(gap_ + w_.dot(t)) / normal_; }

  Real normal_, gap_, mu_;
  Vec2 w_;
  BlockMatrix<2> S_;
  Vec2 r_;
};

bool ClosedTouch::stick(Vec3& lambda) const {
  const Real share = S_(1, 0) / S_(0, 0), pivot = S_(1, 1) - share * S_(1, 0);
  if (!(S_(0, 0) > 0) || !(pivot > 0)) return false;
  Vec2 t;
  t[1] = -(r_[1] - share * r_[0]) / pivot;
  t[0] = -(r_[0] + S_(1, 0) * t[1]) / S_(0, 0);
  const Real n = normal_force(t);
  if (!(n >= 0 && t.norm() <= mu_ * n)) return false;
  lambda << n, t;
  return true;
}

void ClosedTouch::slip(Vec3& lambda) const {
  Vec2 e = S_.diagonal().cwiseMax(0);
  BlockMatrix<2> axes = BlockMatrix<2>::Identity();
  if (S_(1, 0) != 0) {  // laws are most often asked with a diagonal
    Eigen::SelfAdjointEigenSolver<BlockMatrix<2>> eigen;
    eigen.computeDirect(S_);
    e = eigen.eigenvalues().cwiseMax(0);
    axes = eigen.eigenvectors();
  }
  const Vec2 re = axes.transpose() * r_, we = axes.transpose() * w_;
  const Real share = mu_ / normal_;
  Vec2 t;
  Real slope = 0;  // of the excess over k > 0
  const auto excess = [&](Real k) {
    const Vec2 answer = (e.array() + k).inverse();
    t = -re.cwiseProduct(answer);
    const Vec2 dt = -t.cwiseProduct(answer);
    const Real norm = t.norm();
    slope = (norm > 0 ? t.dot(dt) / norm : Real(0)) + share * we.dot(dt);
    return norm + share * (gap_ + we.dot(t));
  };
  // Newton's method, and a bisection where it leaves what encloses the root or is slow. It begins
  // from the root for a W that is alike in both tangents and does not couple them to the normal.
  // After a step of Newton's so small the next would be one of rounding.
  const Real mean = re.squaredNorm() > 0 ? re.cwiseAbs2().dot(e) / re.squaredNorm() : Real(0);
  const Real guess = re.norm() / (-share * gap_) - mean;
  constexpr Real small = 1e-12, rounding = 4e-16, none = std::numeric_limits<Real>::infinity();
  Real k = guess > 0 && guess < none ? guess : std::max(e.maxCoeff(), Real(1e-12) * normal_);
  Real low = 0, high = none, last = 8 * k;
  for (int i = 0; i < 200; ++i) {
    const Real f = excess(k);
    if (f == 0) break;
    (f > 0 ? low : high) = k;
    const Real newton = k - f / slope;
    const bool takes_it = newton > low && newton < high && std::abs(newton - k) < 0.5 * last;
    const Real next = takes_it ? newton : high < none ? 0.5 * (low + high) : 4 * k;
    last = std::abs(next - k);
    k = next;
    if (last <= (takes_it ? small : rounding) * (k + e.minCoeff())) {
      excess(k);
      break;
    }
  }
  const Vec2 along = axes * t;
  const Real n = std::max(normal_force(along), Real(0)), norm = along.norm();
  lambda[0] = n;  // on the cone, to the last bit
  lambda.tail<2>() = norm > 0 ? Vec2(along * (mu_ * n / norm)) : Vec2::Zero();
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
  const ClosedTouch touch(W, d, mu);
  const Friction state = touch.stick(lambda) ? Friction::stick : Friction::slip;
  if (state == Friction::slip) touch.slip(lambda);
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
