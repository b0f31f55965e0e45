#include "solve/redundant_rows.h"

#include <algorithm>
#include <cmath>

namespace sutura {

bool RedundantRows::soften(ConstraintProblem& problem, const Compliance& compliance) {
  // Measured on overhand knots (docs/theory/solver.md): from 1e-4 on every problem is solved in a
  // few sweeps; above 1e-3 passes begin to feel it.
  constexpr Real share = 2e-4;
  own_W_ = problem.W.diagonal();
  d_free_ = problem.d_free;
  before_.setZero(problem.rows());
  give_.setZero(problem.rows());
  bool any = false;
  for (std::size_t block = 0; block < problem.blocks.size(); ++block) {
    const ConstraintBlock& b = problem.blocks[block];
    if (!b.redundant) continue;
    any = true;
    const int dim = b.law->dim;
    Real own = 0;
    for (int k = 0; k < dim; ++k) own = std::max(own, compliance[block][k + k * dim]);
    for (Index i = b.first_row; i < b.first_row + b.law->dim; ++i) {
      give_[i] = share * own;
      problem.W(i, i) += give_[i];
    }
  }
  if (any) take_back(problem);
  return any;
}

void RedundantRows::harden(ConstraintProblem& problem) const {
  problem.W.diagonal() = own_W_;
  problem.d_free = d_free_;
}

Real RedundantRows::take_back(ConstraintProblem& problem) {
  Real most = 0;
  for (Index i = 0; i < problem.rows(); ++i) {
    const Real given = give_[i] * (problem.lambda[i] - before_[i]);
    problem.d_free[i] -= given;
    most = std::max(most, std::abs(given));
  }
  before_ = problem.lambda;
  return most;
}

}  // namespace sutura
