#include "sutura/laws/ball.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace sutura {

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
    constexpr Real small = 1e-12;  // after such a step the next would be one of rounding
    for (int iteration = 0; iteration < 60; ++iteration) {
      y = at(s);
      const Real norm = y.norm();
      Real slope = 0;  // -d(norm)/ds * norm
      for (int i = 0; i < N; ++i) slope += e[i] + s > tiny ? y[i] * y[i] / (e[i] + s) : Real(0);
      if (!(slope > 0)) break;
      const Real step = (norm / limit - 1) * norm * norm / slope;
      s += step;
      if (std::abs(step) <= small * (s + e[0])) break;
    }
    y = at(s);
    lambda = eigen.eigenvectors() * (y * (limit / y.norm()));
    return s;
  }
}

template Real solve_in_ball<1>(const BlockMatrix<1>&, const BlockVector<1>&, Real, BlockVector<1>&);
template Real solve_in_ball<2>(const BlockMatrix<2>&, const BlockVector<2>&, Real, BlockVector<2>&);
template Real solve_in_ball<3>(const BlockMatrix<3>&, const BlockVector<3>&, Real, BlockVector<3>&);
template Real solve_in_ball<6>(const BlockMatrix<6>&, const BlockVector<6>&, Real, BlockVector<6>&);

}  // namespace sutura
