// A force limited to a ball, the part that capped bilateral rows, friction and puncture share:
//
//   minimise  1/2 lambda^T W lambda + d^T lambda   subject to  |lambda| <= limit
//
// that is, either delta = W lambda + d = 0 inside the ball, or |lambda| = limit and
// delta = -s lambda with s >= 0: the point slips against the force. s (m/N) solves the secular
// equation |(W + s I)^-1 d| = limit; Newton on 1/|.| started left of the root is monotone
// (More and Sorensen 1983, "Computing a trust region step").
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>

#include "sutura/law.h"

namespace sutura {

/// lambda <- the solution; returns s (m/N), 0 inside the ball. W is symmetric and not negative.
template <int N>
Real solve_in_ball(const BlockMatrix<N>& W, const BlockVector<N>& d, Real limit,
                   BlockVector<N>& lambda) {
  if (limit <= 0) {
    lambda.setZero();
    return 0;
  }
  if constexpr (N == 1) {
    const Real w = W(0, 0);
    if (std::abs(d[0]) <= w * limit) {
      lambda[0] = w > 0 ? -d[0] / w : Real(0);
      return 0;
    }
    lambda[0] = d[0] > 0 ? -limit : limit;
    return std::abs(d[0]) / limit - w;
  } else {
    Eigen::SelfAdjointEigenSolver<BlockMatrix<N>> eigen;
    if constexpr (N == 2)
      eigen.computeDirect(W);
    else
      eigen.compute(W);
    const BlockVector<N>& e = eigen.eigenvalues();
    const BlockVector<N> g = -(eigen.eigenvectors().transpose() * d);
    // Directions without compliance and without violation carry no force.
    const Real tiny = 1e-14 * e.cwiseAbs().maxCoeff();
    const auto at = [&](Real s) {
      BlockVector<N> y;
      for (int i = 0; i < N; ++i) y[i] = e[i] + s > tiny ? g[i] / (e[i] + s) : Real(0);
      return y;
    };
    Real s = 0;
    for (int i = 0; i < N; ++i) s = std::max(s, std::abs(g[i]) / limit - e[i]);
    BlockVector<N> y = at(0);
    if (s <= 0 && y.norm() <= limit) {
      lambda = eigen.eigenvectors() * y;
      return 0;
    }
    for (int iteration = 0; iteration < 60; ++iteration) {
      y = at(s);
      const Real norm = y.norm();
      Real slope = 0;  // -d(norm)/ds * norm
      for (int i = 0; i < N; ++i) slope += e[i] + s > tiny ? y[i] * y[i] / (e[i] + s) : Real(0);
      if (!(slope > 0)) break;
      const Real step = (norm / limit - 1) * norm * norm / slope;
      s += step;
      if (std::abs(step) <= 1e-15 * s) break;
    }
    y = at(s);
    lambda = eigen.eigenvectors() * (y * (limit / y.norm()));
    return s;
  }
}

/// N - 1 orthonormal columns perpendicular to the unit vector `axis` (Householder reflection).
template <int N>
Eigen::Matrix<Real, N, N - 1> perpendicular_basis(const BlockVector<N>& axis) {
  BlockVector<N> v = axis;
  v[0] += axis[0] >= 0 ? 1 : -1;
  const BlockMatrix<N> Q = BlockMatrix<N>::Identity() - (2 / v.squaredNorm()) * v * v.transpose();
  return Q.template rightCols<N - 1>();
}

}  // namespace sutura
