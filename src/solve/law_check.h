// How far the bodies are from the laws once they have moved: the natural map at the violation that
// was measured at the new guess, with the compliance of the pass that led there.
#pragma once

#include <vector>

#include "solve/compliance.h"
#include "solve/law_residual.h"
#include "sutura/constraints.h"

namespace sutura {

class LawCheck {
 public:
  /// Remembers the diagonal block of W of every block, by key; d_free -= W lambda: the bodies have
  /// moved under lambda already, and the laws are to be solved for the whole of it.
  void begin(ConstraintProblem& problem);
  struct Miss : Residual {
    Real relative = 0;  ///< violation beside what is allowed: `tolerance`, or less for some blocks
  };
  /// Of problem.delta and problem.lambda as they are; fills in the violation of each block. A block
  /// that `begin` has not seen counts with the compliance that its units make.
  Miss measure(ConstraintProblem& problem, Real tolerance);

 private:
  struct Known {
    Key key;
    std::size_t first;  ///< of its dim x dim numbers
    int dim;
  };
  Compliance compliance_;
  std::vector<Known> known_;  ///< sorted by key
  std::vector<Real> diagonal_;
  GrowingVec d_free_;
};

}  // namespace sutura
