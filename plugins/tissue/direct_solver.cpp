#include "direct_solver.h"

namespace sutura {

void DirectSolver::analyse(std::shared_ptr<const NodePattern> pattern, std::span<const char> fixed,
                           std::span<const Index> candidates) {
  plan_ = make_factor_plan(*pattern, fixed, candidates, backend_);
  factor_ = make_factor(plan_);
  fixed_.assign(fixed.begin(), fixed.end());
  fixed_.resize(static_cast<std::size_t>(pattern->nodes()), 0);
  place_.assign(fixed_.size(), -1);
  Index place = 0;
  for (const Index i : tail_nodes(*plan_)) place_[i] = place++;
}

void DirectSolver::prepare(const NodeMatrix& A, std::span<const Mat3>, Index step) {
  const Index failed = report_.failed_factors;
  report_ = {};
  usable_ = factor_->factorise(A);
  tail_current_ = false;
  report_.adopted_at = step;
  report_.converged = usable_;
  report_.failed_factors = failed + (usable_ ? 0 : 1);
  if (!usable_) report_.message = "the matrix of the tissue is not positive definite or not finite";
}

void DirectSolver::solve(Eigen::Ref<MatX> columns) {
  report_.solves += columns.cols();
  if (usable_) factor_->solve(columns);
  else columns.setZero();
}

bool DirectSolver::has_compliance(std::span<const Index> nodes) const {
  if (!usable_) return false;
  for (const Index i : nodes)
    if (place_[i] < 0 && !fixed_[i]) return false;
  return true;
}

Mat3 DirectSolver::compliance_block(Index i, Index j) const {
  if (fixed_[i] || fixed_[j]) return Mat3::Zero();
  if (!tail_current_) {
    tail_ = factor_->tail_compliance();
    tail_current_ = true;
  }
  return tail_.block<3, 3>(3 * place_[i], 3 * place_[j]);
}

std::unique_ptr<TissueSolver> make_direct_solver() { return std::make_unique<DirectSolver>(); }

}  // namespace sutura
