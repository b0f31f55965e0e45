// Where Newton's method over the tangents does not end: the slower walk of the direct step.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "solve/subspace_step.h"

namespace sutura {

void SubspaceStep::hold(const ConstraintProblem& problem, Compliance& compliance,
                        const GrowingVec& lambda, std::size_t block) {
  const ConstraintBlock& b = problem.blocks[block];
  const int dim = b.law->dim;
  Real d[max_block_dim], delta[max_block_dim], plus[max_block_dim];
  const Real none[max_block_dim] = {};
  own_free_violation(dim, compliance[block], none, lambda.data() + b.first_row, d);
  std::copy_n(lambda.data() + b.first_row, dim, plus);
  Mode mode = b.mode;
  b.law->project({compliance[block], d, problem.block_params(b), &mode, plus});
  for (int k = 0; k < dim; ++k) {
    delta[k] = d[k];
    for (int j = 0; j < dim; ++j) delta[k] += compliance[block][k + j * dim] * plus[j];
    base_[b.first_row + k] = plus[k];
  }
  b.law->free_directions({compliance[block], delta, problem.block_params(b), &mode, plus},
                         tangents_[block]);
}

bool SubspaceStep::admissible(const ConstraintProblem& problem, Compliance& compliance,
                              const GrowingVec& lambda, std::size_t block) const {
  using Small =
      Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, 0, max_block_dim, max_block_dim>;
  using SmallVector = Eigen::Matrix<Real, Eigen::Dynamic, 1, 0, max_block_dim, 1>;
  const ConstraintBlock& b = problem.blocks[block];
  const FreeDirectionsView& free = tangents_[block];
  const int dim = b.law->dim, f = free.count;
  const Eigen::Map<const MatX> W(compliance[block], dim, dim), move(free.move, dim, f),
      test(free.test, dim, f);
  const SmallVector l = lambda.segment(b.first_row, dim);
  // Coordinates of l on the tangent, and the smallest delta that the tangent then asks for.
  const Small moves = move.transpose() * move, tests = test.transpose() * test;
  const SmallVector off = l - base_.segment(b.first_row, dim), along = move.transpose() * off;
  const SmallVector y = moves.ldlt().solve(along);
  SmallVector asked(f);
  for (int i = 0; i < f; ++i) {
    asked[i] = -free.gap[i];
    for (int j = 0; j < f; ++j) asked[i] -= free.compliance[i + j * dim] * y[j];
  }
  const SmallVector delta = test * tests.ldlt().solve(asked);
  SmallVector d = delta - W * l, plus = l;
  Mode mode = b.mode;
  b.law->project({compliance[block], d.data(), problem.block_params(b), &mode, plus.data()});
  return (plus - l).norm() <= 1e-9 * (l.norm() + 1e-3 * b.units.force);
}

void SubspaceStep::walk(ConstraintProblem& problem, Compliance& compliance, Real tolerance,
                        GrowingVec& lambda_plus, SolveReport& report) {
  damping_ = undamped;
  const std::size_t blocks = problem.blocks.size();
  natural_map(problem, compliance, lambda_plus, &block_residual_);
  ask(problem, compliance);
  for (std::size_t i = 0; i < blocks; ++i) {
    if (block_residual_[i] <= tolerance)
      take_tangent(problem, compliance, i);
    else
      hold(problem, compliance, problem.lambda, i);
  }
  // At most 1e9 multiplications, some tenths of a second: counted, not timed, so that results do
  // not depend on the machine.
  const Real n = static_cast<Real>(problem.rows());
  const auto affordable = static_cast<std::size_t>(1e9 / (n * n * n / 6 + 2 * n * n));
  const std::size_t most_steps = std::min(3 * blocks + 20, affordable);
  GrowingVec& from = walk_from_;
  GrowingVec& way = walk_way_;
  for (std::size_t step = 0; step < most_steps; ++step) {
    collect(problem);
    from = problem.lambda;
    if (!solve(problem, compliance, report)) return;
    ++report.direct_solves;
    way = problem.lambda - from;
    Real length = 1;
    stops_.assign(blocks, Real(2));
    for (std::size_t i = 0; i < blocks; ++i) {
      if (tangents_[i].count == 0) continue;
      const ConstraintBlock& b = problem.blocks[i];
      auto here = problem.lambda.segment(b.first_row, b.law->dim);
      const auto may_go = [&](Real t) {
        here = from.segment(b.first_row, b.law->dim) + t * way.segment(b.first_row, b.law->dim);
        return admissible(problem, compliance, problem.lambda, i);
      };
      // Only who stops first matters: whoever gets as far as that need not be followed further.
      if (!may_go(length)) {
        Real low = 0, high = length;
        while (high - low > 1e-15) {
          const Real middle = 0.5 * (low + high);
          (may_go(middle) ? low : high) = middle;
        }
        stops_[i] = low;
        length = low;
      }
      may_go(1);
    }
    if (length == 1) {
      // Free to go all the way. Now the one clamped block that most wants to leave its limit may.
      const Residual residual = natural_map(problem, compliance, lambda_plus, &block_residual_);
      keep_best(problem, residual);
      if (!(residual.value > tolerance)) return;
      const auto worst = std::max_element(block_residual_.begin(), block_residual_.end());
      ask(problem, compliance);
      take_tangent(problem, compliance, static_cast<std::size_t>(worst - block_residual_.begin()));
      continue;
    }
    problem.lambda = from + length * way;
    for (std::size_t i = 0; i < blocks; ++i) {
      if (stops_[i] > length + 1e-12) continue;
      // Clamped where it stopped: the law's answer just beyond.
      const ConstraintBlock& b = problem.blocks[i];
      column_.resize(problem.rows());
      column_ = from + (length + 1e-6) * way;
      hold(problem, compliance, column_, i);
      problem.lambda.segment(b.first_row, b.law->dim) = base_.segment(b.first_row, b.law->dim);
    }
    compliance.update_delta(problem);
  }
}

}  // namespace sutura
