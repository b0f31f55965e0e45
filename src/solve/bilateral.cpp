#include "sutura/laws/bilateral.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace sutura {

template <int N>
void Bilateral<N>::project(const BlockMatrix<N>& W, const BlockVector<N>& d, const Params& p,
                           Mode& mode, BlockVector<N>& lambda) {
  BlockMatrix<N> total = W;
  total.diagonal().array() += p.compliance;
  mode = holding;
  const Eigen::LLT<BlockMatrix<N>> factor(total);
  if (factor.info() == Eigen::Success) {
    const BlockVector<N> held = -factor.solve(d);
    if (held.allFinite() && held.norm() <= p.cap) {
      lambda = held;
      return;
    }
  }
  // Over the cap, or rows that repeat each other.
  const Real limit = std::isfinite(p.cap) ? p.cap : Real(1e12);
  if (solve_in_ball<N>(total, d, limit, lambda) > 0) mode = capped;
}

template <int N>
void Bilateral<N>::free_directions(const BlockVector<N>& delta, const Params& p, Mode mode,
                                   const BlockVector<N>& lambda, FreeDirections<N>& free) {
  if (mode == holding) {
    free.count = N;
    free.gap = p.compliance * lambda;
    free.compliance.diagonal().setConstant(p.compliance);
    return;
  }
  // At the cap the force may only turn: |lambda| = cap, delta + c lambda = -s lambda.
  free.count = N - 1;
  if constexpr (N > 1) {
    const Real norm = lambda.norm();
    if (!(norm > 0)) {
      free.count = 0;
      return;
    }
    const Real s = (delta + p.compliance * lambda).norm() / norm;
    const auto turn = perpendicular_basis<N>(lambda / norm);
    free.move.template leftCols<N - 1>() = turn;
    free.test.template leftCols<N - 1>() = turn;
    free.compliance.diagonal().setConstant(p.compliance + s);
  }
}

template struct Bilateral<1>;
template struct Bilateral<2>;
template struct Bilateral<3>;
template struct Bilateral<6>;

}  // namespace sutura
