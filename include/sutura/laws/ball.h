// A force limited to a ball, the part that capped bilateral rows, friction and puncture share:
//
//   minimise  1/2 lambda^T W lambda + d^T lambda   subject to  |lambda| <= limit
//
// that is, either delta = W lambda + d = 0 inside the ball, or |lambda| = limit and
// delta = -s lambda with s >= 0: the point slips against the force. s (m/N) solves the secular
// equation |(W + s I)^-1 d| = limit; Newton on 1/|.| started left of the root is monotone
// (More and Sorensen 1983, "Computing a trust region step").
#pragma once

#include "sutura/law.h"

namespace sutura {

/// lambda <- the solution; returns s (m/N), 0 inside the ball. W is symmetric and not negative.
/// Compiled in the library for N = 1, 2, 3 and 6.
template <int N>
Real solve_in_ball(const BlockMatrix<N>& W, const BlockVector<N>& d, Real limit,
                   BlockVector<N>& lambda);

/// N - 1 orthonormal columns perpendicular to the unit vector `axis` (Householder reflection).
template <int N>
Eigen::Matrix<Real, N, N - 1> perpendicular_basis(const BlockVector<N>& axis) {
  BlockVector<N> v = axis;
  v[0] += axis[0] >= 0 ? 1 : -1;
  const BlockMatrix<N> Q = BlockMatrix<N>::Identity() - (2 / v.squaredNorm()) * v * v.transpose();
  return Q.template rightCols<N - 1>();
}

}  // namespace sutura
