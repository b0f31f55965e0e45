#include "solve/reference_solver.h"

#include <algorithm>
#include <cmath>

namespace sutura {

void ReferenceSolver::set_rho(Real rho) {
  rho_ = rho;
  penalty_ = rho * weight_;
  MatX M = W_;
  M.diagonal() += penalty_;
  factor_.compute(M);
}

Residual ReferenceSolver::admm(ConstraintProblem& problem, Index count, Real target,
                               Index& iterations) {
  GrowingVec& z = problem.lambda;
  Residual residual;
  VecX z_before;
  for (Index k = 0; k < count; ++k) {
    ++iterations;
    x_ = factor_.solve(penalty_.cwiseProduct(z) + s_ - problem.d_free);
    z_before = z;
    for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
      ConstraintBlock& b = problem.blocks[i];
      const int dim = b.law->dim;
      Real P[max_block_dim * max_block_dim] = {}, d[max_block_dim];
      for (int j = 0; j < dim; ++j) {
        const Index row = b.first_row + j;
        P[j + j * dim] = penalty_[row];
        d[j] = s_[row] - penalty_[row] * x_[row];
      }
      b.law->project({P, d, problem.block_params(b), &b.mode, z.data() + b.first_row});
      for (int j = 0; j < dim; ++j) {
        const Index row = b.first_row + j;
        s_[row] = penalty_[row] * z[row] + d[j];
      }
    }
    if (k % 5 != 4 && k + 1 != count) continue;
    compliance_.update_delta(problem);
    residual = natural_map(problem, compliance_, lambda_plus_);
    if (!(residual.value > target)) break;
    // Balance: x and z apart (rho too small), z still moving (rho too large).
    const Real apart = (x_ - z).cwiseProduct(penalty_).norm();
    const Real moving = (z - z_before).cwiseProduct(penalty_).norm();
    if (k % 25 == 24 && moving > 0 && apart > 0) {
      const Real ratio = apart / moving;
      if (ratio > 10 || ratio < 0.1)
        set_rho(std::clamp(rho_ * std::clamp(std::sqrt(ratio), 0.1, 10.0), 1e-9, 1e6));
    }
  }
  return residual;
}

SolveReport ReferenceSolver::solve(ConstraintProblem& problem) {
  SolveReport report;
  if (problem.blocks.empty()) return report;
  compliance_.prepare(problem);
  W_ = problem.W;
  subspace_.begin();
  weight_.resize(problem.rows());
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    const ConstraintBlock& b = problem.blocks[i];
    Real mean = 0;
    for (int j = 0; j < b.law->dim; ++j) mean += compliance_[i][j + j * b.law->dim] / b.law->dim;
    weight_.segment(b.first_row, b.law->dim).setConstant(mean > 0 ? mean : 1);
  }
  set_rho(0.1);

  compliance_.update_delta(problem);
  s_ = problem.delta;
  Residual residual = natural_map(problem, compliance_, lambda_plus_);
  // Newton from further and further down, until it converges.
  Real target = 1e-2;
  while (true) {
    if (residual.value <= options_.tolerance) {
      const Index fired = fire_events(problem);
      if (fired == 0) break;
      report.events += fired;
      residual = natural_map(problem, compliance_, lambda_plus_);
      target = 1e-2;
      continue;
    }
    if (report.sweeps >= options_.iterations || !std::isfinite(residual.value)) break;
    constexpr Index turn = 100;
    const Index count = std::min(turn, options_.iterations - report.sweeps);
    residual = admm(problem, count, options_.newton ? target : options_.tolerance, report.sweeps);
    if (options_.newton) {
      const VecX lambda = problem.lambda;
      const Residual polished = subspace_.newton(problem, compliance_, residual, options_.tolerance,
                                                 lambda_plus_, report, target < 1e-4);
      if (polished.value <= 0.1 * residual.value)
        s_ = problem.delta;
      else
        problem.lambda = lambda;  // not near enough: ADMM goes on where it was
      compliance_.update_delta(problem);
      residual = natural_map(problem, compliance_, lambda_plus_);
      target = std::max(0.1 * target, options_.tolerance);
    }
  }
  report.residual = residual.value;
  report.violation = residual.violation;
  report.converged = residual.value <= options_.tolerance;
  return report;
}

}  // namespace sutura
