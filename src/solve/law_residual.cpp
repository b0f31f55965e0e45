#include "solve/law_residual.h"

#include <algorithm>
#include <cmath>

namespace sutura {

Real Residual::add(ConstraintBlock& block, const Real* W, const Real* change) {
  const int dim = block.law->dim;
  Real force = 0, length = 0;
  for (int i = 0; i < dim; ++i) {
    Real moved = 0;
    for (int j = 0; j < dim; ++j) moved += W[i + j * dim] * change[j];
    force += change[i] * change[i];
    length += moved * moved;
  }
  force = std::sqrt(force);
  length = std::sqrt(length);
  block.violation = length;
  const Real here = std::max(force / block.units.force, length / block.units.length);
  // Written so that a NaN stays.
  if (!(here <= value)) value = here;
  if (!(length <= violation)) violation = length;
  return here;
}

Residual natural_map(ConstraintProblem& problem, const Compliance& compliance,
                     GrowingVec& lambda_plus, std::vector<Real>* per_block) {
  if (per_block != nullptr) per_block->resize(problem.blocks.size());
  Residual residual;
  lambda_plus.resize(problem.rows());
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    ConstraintBlock& b = problem.blocks[i];
    const int dim = b.law->dim;
    const Real* W = compliance[i];
    const Real* lambda = problem.lambda.data() + b.first_row;
    Real* plus = lambda_plus.data() + b.first_row;
    Real d[max_block_dim], change[max_block_dim];
    own_free_violation(dim, W, problem.delta.data() + b.first_row, lambda, d);
    std::copy_n(lambda, dim, plus);
    b.law->project({W, d, problem.block_params(b), &b.mode, plus});
    for (int k = 0; k < dim; ++k) change[k] = plus[k] - lambda[k];
    const Real here = residual.add(b, W, change);
    if (per_block != nullptr) (*per_block)[i] = here;
  }
  return residual;
}

Index fire_events(ConstraintProblem& problem) {
  Index fired = 0;
  for (ConstraintBlock& b : problem.blocks)
    if (b.law->event != nullptr &&
        b.law->event(problem.block_params(b), problem.delta.data() + b.first_row, &b.mode,
                     problem.lambda.data() + b.first_row))
      ++fired;
  return fired;
}

}  // namespace sutura
