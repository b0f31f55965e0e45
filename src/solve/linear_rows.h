// Rows that are linear whatever the forces are: what is held without a cap. They are eliminated
// once for a solve, and sweeps and direct steps see the others alone, with
//
//   W' = W_oo - W_oh (W_hh + C)^-1 W_ho,    d' = d_o - W_oh (W_hh + C)^-1 d_h
//
// (h held, with compliance C; o others): static condensation. Forces that turn are among them where
// all is stable with them. docs/theory/solver.md.
#pragma once

#include <vector>

#include "sutura/constraints.h"
#include "sutura/laws/turning_force.h"

namespace sutura {

class LinearRows {
 public:
  /// False if there is nothing to eliminate, or nothing else to solve and nothing that turns.
  bool find(const ConstraintProblem& problem) { return find(problem, true); }
  /// Blocks that are not held, ascending.
  const std::vector<std::size_t>& others() const { return other_; }
  /// `others` <- the problem without the rows that were found. Forces that turn become whole; where
  /// something is not stable with them, they are among the others, as springs. False if held rows
  /// repeat each other up to rounding.
  bool eliminate(ConstraintProblem& problem, ConstraintProblem& others);
  /// The others could not be solved: forces that turn are springs again.
  void give_up(ConstraintProblem& problem) const { set_mode(problem, TurningForce::spring); }
  /// Forces and modes of all rows from those of the others.
  void put_back(const ConstraintProblem& others, ConstraintProblem& problem);
  /// After `put_back`, and with the delta of its forces: `others` <- what rounding has left to
  /// solve (iterative refinement).
  void refine(const ConstraintProblem& problem, ConstraintProblem& others);

 private:
  bool find(const ConstraintProblem& problem, bool with_turning);
  void set_mode(ConstraintProblem& problem, Mode mode) const;
  void gather(const ConstraintProblem& problem);
  bool factorise();

  std::vector<std::size_t> other_;        ///< blocks that are not held
  std::vector<Index> rows_, other_rows_;  ///< of the problem: the held ones, then the others
  std::vector<std::size_t> turning_;      ///< blocks of forces that turn, eliminated as a whole
  Index held_ = 0;                        ///< how many rows are eliminated
  Index positive_ = 0;                    ///< the first of them, which have positive pivots
  GrowingVec scale_;                      ///< S, of the held rows: to a unit diagonal
  GrowingVec compliance_, coupling_;      ///< C: its diagonal, and beside it where forces turn
  /// [L, .; W_oh S L^-T J, W'; (J L^-1 S d_h)^T, d'^T] with L J L^T = S (W_hh + C) S; J is 1 for
  /// positive pivots, else -1.
  GrowingMat matrix_;
  GrowingVec force_, before_;  ///< of the held rows: what to add, and to what
};

}  // namespace sutura
