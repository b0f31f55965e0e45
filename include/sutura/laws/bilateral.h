// Bilateral: two things are held together.
//
//   delta = -c lambda                                while |lambda| <= cap
//   delta + c lambda antiparallel to lambda          when  |lambda|  = cap
//
// delta (m) relative displacement that should vanish, lambda (N) force, c (m/N) compliance of the
// hold (0: rigid), cap (N) what it can carry (infinite by default): beyond, it slips with that
// force, as a tissue that tears or a jaw that lets go. The cap is on the Euclidean norm, so that
// the law does not depend on the choice of axes; with 6 rows the source scales the rotational ones
// by a length, so that all rows are in metres and newtons. Source: algorithms.md B.6.
#pragma once

#include <limits>

#include "sutura/laws/ball.h"

namespace sutura {

template <int N>
struct Bilateral {
  static constexpr int dim = N;
  static constexpr const char* name = N == 1   ? "bilateral1"
                                      : N == 2 ? "bilateral2"
                                      : N == 3 ? "bilateral3"
                                               : "bilateral6";
  static_assert(N == 1 || N == 2 || N == 3 || N == 6);

  struct Params {
    Real compliance = 0;                               ///< c, m/N
    Real cap = std::numeric_limits<Real>::infinity();  ///< N
  };
  static constexpr Mode holding = 0;
  static constexpr Mode capped = 1;

  static void project(const BlockMatrix<N>& W, const BlockVector<N>& d, const Params& p, Mode& mode,
                      BlockVector<N>& lambda) {
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

  static void free_directions(const BlockVector<N>& delta, const Params& p, Mode mode,
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
};

}  // namespace sutura
