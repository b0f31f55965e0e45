// TurningForce: a force across a curve turns with it.
//
// A force f (N) holds a curve at a point beside it, and stays across it. delta[0] = a (m): how far
// the curve goes along itself, past that point. delta[1] = b (m): how far the end of an arm of
// length l, fixed to the curve along its tangent, goes in the direction of f. Both turn f, and a
// shifts the section that it acts on:
//
//   lambda = -(k a + c b, c a),        k = -f . (curvature),    c = |f| / l
//
// This is the second derivative of the gap, times f, which rows do not say; it is worked out in
// docs/theory/suturing.md. It pushes some motions on as it holds others back, so that no sweep
// finds its force: LinearRows eliminates it, where all is stable with it. Elsewhere it is a spring
// k along the curve, or nothing if k is negative.
#pragma once

#include "sutura/law.h"

namespace sutura {

struct TurningForce {
  static constexpr int dim = 2;
  static constexpr const char* name = "turning_force";
  struct Params {
    Real stiffness = 0;  ///< k, N/m
    Real coupling = 1;   ///< c, N/m, more than 0
  };
  static constexpr Mode spring = 0;
  static constexpr Mode whole = 1;

  /// delta = -compliance * lambda, as a whole.
  static BlockMatrix<2> compliance(const Params& p);
  static void project(const BlockMatrix<2>& W, const BlockVector<2>& d, const Params& p, Mode& mode,
                      BlockVector<2>& lambda);
  static void free_directions(const BlockVector<2>& delta, const Params& p, Mode mode,
                              const BlockVector<2>& lambda, FreeDirections<2>& free);
};

}  // namespace sutura
