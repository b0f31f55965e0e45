#include "solve/law_residual.h"

#include <algorithm>
#include <cmath>

namespace sutura {

Real Residual::ask(const ConstraintProblem& problem, ConstraintBlock& block, const Real* W,
                   Mode& mode, Real* lambda_plus) {
  const int dim = block.law->dim;
  const Real* lambda = problem.lambda.data() + block.first_row;
  const Real* delta = problem.delta.data() + block.first_row;
  Real D[max_block_dim * max_block_dim] = {}, d[max_block_dim];
  for (int i = 0; i < dim; ++i) {
    D[i + i * dim] = W[i + i * dim];
    d[i] = delta[i] - W[i + i * dim] * lambda[i];
    lambda_plus[i] = lambda[i];
  }
  block.law->project({D, d, problem.block_params(block), &mode, lambda_plus});
  Real force = 0, length = 0;
  for (int i = 0; i < dim; ++i) {
    const Real change = lambda_plus[i] - lambda[i], moved = D[i + i * dim] * change;
    force += change * change;
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
    const Real here =
        residual.ask(problem, b, compliance[i], b.mode, lambda_plus.data() + b.first_row);
    if (per_block != nullptr) (*per_block)[i] = here;
  }
  return residual;
}

namespace {

/// What the event of a block makes of its mode.
bool fire(const ConstraintProblem& problem, const ConstraintBlock& b, Mode& mode) {
  return b.law->event != nullptr &&
         b.law->event(problem.block_params(b), problem.delta.data() + b.first_row, &mode,
                      problem.lambda.data() + b.first_row);
}

}  // namespace

Index fire_events(ConstraintProblem& problem) {
  Index fired = 0;
  for (ConstraintBlock& b : problem.blocks) fired += fire(problem, b, b.mode);
  return fired;
}

bool timed_event_is_due(const ConstraintProblem& problem) {
  return std::any_of(problem.blocks.begin(), problem.blocks.end(), [&](const ConstraintBlock& b) {
    Mode mode = b.mode;
    return b.timed && fire(problem, b, mode);
  });
}

}  // namespace sutura
