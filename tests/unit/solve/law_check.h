// Helpers for one-block tests: a law's answer must lie on its graph, and on the branch that an
// independent enumeration of the cases finds.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "solve_problems.h"

namespace sutura::test {

inline constexpr int draws = 100000;

/// A length with no preferred scale, positive or negative.
inline Real draw_real(std::mt19937_64& random, Real low_decade, Real high_decade) {
  std::uniform_real_distribution<Real> exponent(low_decade, high_decade), sign(-1, 1);
  return std::copysign(std::pow(10, exponent(random)), sign(random));
}
inline Real draw_positive(std::mt19937_64& random, Real low_decade, Real high_decade) {
  return std::abs(draw_real(random, low_decade, high_decade));
}
template <int N>
BlockVector<N> draw_vector(std::mt19937_64& random) {
  BlockVector<N> v;
  for (int i = 0; i < N; ++i) v[i] = draw_real(random, -2, 1);
  return v;
}
inline Vec3 draw_unit(std::mt19937_64& random) {
  std::normal_distribution<Real> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

/// The answer must not depend on where the iteration stands.
template <Law L>
BlockVector<L::dim> project_twice(const BlockMatrix<L::dim>& W, const BlockVector<L::dim>& d,
                                  const typename L::Params& p, Mode& mode) {
  BlockVector<L::dim> a = BlockVector<L::dim>::Zero(), b = BlockVector<L::dim>::Constant(7);
  Mode mode_b = mode;
  L::project(W, d, p, mode, a);
  L::project(W, d, p, mode_b, b);
  EXPECT_EQ(mode, mode_b);
  EXPECT_EQ(a, b);
  return a;
}

/// A step of `size` in the free coordinates, mapped back by the law: the point (lambda + move y,
/// delta) with test^T delta + gap + compliance y = 0 must stay on the graph up to second order.
/// Returns the distance, as the change that the law asks for, divided by |move y|.
template <Law L>
Real tangent_error(const BlockMatrix<L::dim>& W, const BlockVector<L::dim>& d,
                   const typename L::Params& p, Mode mode, const BlockVector<L::dim>& lambda,
                   Real size, std::mt19937_64& random) {
  constexpr int n = L::dim;
  FreeDirections<n> free;
  const BlockVector<n> delta = d + W * lambda;
  L::free_directions(delta, p, mode, lambda, free);
  if (free.count == 0) return 0;
  const int f = free.count;
  BlockVector<n> direction = BlockVector<n>::Zero();
  std::normal_distribution<Real> normal;
  for (int j = 0; j < f; ++j) direction[j] = normal(random);
  const BlockVector<n> y = size * direction / direction.norm();
  const BlockVector<n> moved = lambda + free.move.leftCols(f) * y.head(f);
  // The smallest change of delta that keeps the tangent's condition.
  const auto T = free.test.leftCols(f);
  const Eigen::Matrix<Real, Eigen::Dynamic, 1> rhs =
      -(T.transpose() * delta + free.gap.head(f) + free.compliance.topLeftCorner(f, f) * y.head(f));
  const MatX TT = T.transpose() * T;
  const BlockVector<n> delta_moved = delta + T * TT.fullPivLu().solve(rhs);
  BlockVector<n> answer = moved;
  L::project(W, delta_moved - W * moved, p, mode, answer);
  return (answer - moved).norm() / (moved - lambda).norm();
}

}  // namespace sutura::test
