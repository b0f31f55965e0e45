#include "solve/redundant_rows.h"

#include <algorithm>

namespace sutura {

void soften_redundant_rows(ConstraintProblem& problem) {
  // Measured on overhand knots (docs/theory/solver.md): from 1e-4 on every problem is solved in a
  // few sweeps; above 1e-3 passes begin to feel it.
  constexpr Real share = 2e-4;
  for (const ConstraintBlock& b : problem.blocks) {
    if (!b.redundant) continue;
    Real own = 0;
    for (Index i = b.first_row; i < b.first_row + b.law->dim; ++i)
      own = std::max(own, problem.W(i, i));
    for (Index i = b.first_row; i < b.first_row + b.law->dim; ++i) {
      problem.W(i, i) += share * own;
      problem.d_free[i] -= share * own * problem.lambda[i];
    }
  }
}

}  // namespace sutura
