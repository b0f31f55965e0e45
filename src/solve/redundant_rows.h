// Rows that repeat or contradict each other.
//
// Strands that lie along each other touch in many places at once, and a knot couples more touches
// than the thread between them can tell apart: W is singular, forces that cancel each other are
// free, and two linearised gaps may ask for the impossible. Sweeps and direct steps then never end.
// So blocks of this kind may give way a little,
//
//   delta = W lambda + d_free + R (lambda - lambda_before),   R = share * the block's own W,
//
// which makes the answer unique. Solved again from there, with lambda_before = lambda, what R let
// go shrinks by about the share each time, wherever the rows can be satisfied; what cannot is left
// to the next pass, which begins from these forces. This is the proximal point method (R. T.
// Rockafellar, SIAM J. Control Optim. 14, 1976).
#pragma once

#include "solve/compliance.h"
#include "sutura/constraints.h"

namespace sutura {

class RedundantRows {
 public:
  /// Adds R to W, for a solve that begins at the present lambda. `compliance`: own W of the blocks.
  /// False if no block is redundant.
  bool soften(ConstraintProblem& problem, const Compliance& compliance);
  /// After a solve: the present lambda is the one before now. Returns the largest length by which a
  /// row had given way (m).
  Real take_back(ConstraintProblem& problem);
  /// W and d_free are again what they were before `soften`.
  void harden(ConstraintProblem& problem) const;

 private:
  GrowingVec give_;            ///< R, per row (m/N); 0 for the others
  GrowingVec before_;          ///< lambda before
  GrowingVec own_W_, d_free_;  ///< the diagonal of W, and d_free, without R
};

}  // namespace sutura
