// Rows that are linear whatever the forces are: what is held without a cap. They are eliminated
// once for a solve, and sweeps and direct steps see the others alone, with
//
//   W' = W_oo - W_oh (W_hh + C)^-1 W_ho,    d' = d_o - W_oh (W_hh + C)^-1 d_h
//
// (h held, with compliance C; o others): static condensation. docs/theory/solver.md.
#pragma once

#include <vector>

#include "sutura/constraints.h"

namespace sutura {

class LinearRows {
 public:
  /// False if there is nothing to eliminate, or nothing else.
  bool find(const ConstraintProblem& problem);
  /// Blocks that are not held, ascending.
  const std::vector<std::size_t>& others() const { return other_; }
  /// `others` <- the problem without the rows that were found. False if these repeat each other up
  /// to rounding.
  bool eliminate(const ConstraintProblem& problem, ConstraintProblem& others);
  /// Forces and modes of all rows from those of the others.
  void put_back(const ConstraintProblem& others, ConstraintProblem& problem);

 private:
  void gather(const ConstraintProblem& problem);
  bool factorise();

  std::vector<std::size_t> other_;        ///< blocks that are not held
  std::vector<Index> rows_, other_rows_;  ///< of the problem: the held ones, then the others
  Index held_ = 0;                        ///< how many are held
  GrowingVec scale_;                      ///< S, of the held rows: to a unit diagonal
  GrowingMat matrix_;  ///< [L, .; W_oh S L^-T, W'; (L^-1 S d_h)^T, d'^T], L L^T = S (W_hh + C) S
  GrowingVec force_;
};

}  // namespace sutura
