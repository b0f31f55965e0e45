// Bilateral: two things are held together.
//
//   delta = -c lambda                                while |lambda| <= cap
//   delta + c lambda antiparallel to lambda          when  |lambda|  = cap
//
// delta (m) relative displacement that should vanish, lambda (N) force, c (m/N) compliance of the
// hold (0: rigid), cap (N) what it can carry (infinite by default): beyond, it slips with that
// force, as a tissue that tears or a jaw that lets go. The cap is on the Euclidean norm, so that
// the law does not depend on the choice of axes; with 6 rows the source scales the rotational ones
// by a length, so that all rows are in metres and newtons.
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
                      BlockVector<N>& lambda);
  static void free_directions(const BlockVector<N>& delta, const Params& p, Mode mode,
                              const BlockVector<N>& lambda, FreeDirections<N>& free);
};

}  // namespace sutura
