// Blocks that are wide open and carry nothing, as most touches of a loose knot: a pass leaves them
// out of W and of its solve. Where the answer of the bodies closes one, the pass is solved again
// with it, so that what comes out is a solution of all blocks.
#pragma once

#include <vector>

#include "sutura/constraints.h"

namespace sutura {

class IdleBlocks {
 public:
  explicit IdleBlocks(std::size_t bodies);
  /// Before a pass: which are idle.
  void find(const ConstraintProblem& problem);
  /// The others: blocks, rows and H, with the d_free and lambda that `problem` has. W is not made.
  ConstraintProblem& without(const ConstraintProblem& problem);
  /// Once they are solved: their lambda and modes. Those that are idle are open.
  void put_back(ConstraintProblem& problem) const;
  /// Idle blocks that are closed by the d_free of `problem` are idle no more. False if none is.
  bool wake(const ConstraintProblem& problem);

 private:
  void gather_rows(const BodyRows& from, BodyRows& to) const;

  std::vector<char> is_idle_;  ///< per block
  std::vector<Index> row_;     ///< per row of all: its number among the others, -1 if it is idle
  ConstraintProblem others_;
};

}  // namespace sutura
