#include "direct_solver.h"

#include <algorithm>
#include <cassert>

#include "sutura/archive.h"

namespace sutura::tissue {

void SynchronousSolver::analyse(std::shared_ptr<const NodePattern> pattern,
                                std::span<const char> fixed, std::span<const Index> candidates) {
  fixed_.assign(fixed.begin(), fixed.end());
  number_.resize(static_cast<std::size_t>(pattern->nodes()));
  x_.resize(3 * pattern->nodes());
  for (VecX* v : {&in_, &out_}) v->resize(3 * pattern->nodes());
  candidates_.reset(pattern, fixed, candidates);
  plan_ =
      make_factor_plan(std::move(pattern), fixed_, candidates_.chosen(), backend_, cache_.get());
  adopt_plan();
  report_ = {};
}

void SynchronousSolver::adopt_plan() {
  factor_ = make_factor(plan_);
  std::fill(number_.begin(), number_.end(), -1);
  const auto candidates = candidates_of(*plan_);
  for (std::size_t k = 0; k < candidates.size(); ++k)
    number_[static_cast<std::size_t>(candidates[k])] = static_cast<Index>(k);
}

void SynchronousSolver::prepare(const NodeMatrix& A, std::span<const Mat3>, Index step, bool same) {
  assert(factor_);
  A_ = &A;
  step_ = step;
  Index analyses = report_.analyses;
  if (candidates_.outgrown()) {
    ++analyses;
    candidates_.choose(step);
    plan_ = with_candidates(*plan_, candidates_.chosen());
    adopt_plan();
    same = false;
  }
  const Index failed = report_.failed_factors, adopted = report_.adopted_at;
  report_ = {};
  report_.failed_factors = failed;
  report_.analyses = analyses;
  report_.adopted_at = adopted;
  if (same && ok_) return;
  ok_ = factor_->factorise(A);
  has_compliance_ = false;
  report_.failed_factors += ok_ ? 0 : 1;
  if (!same) report_.adopted_at = step;
  if (!ok_) report_.complain("the matrix is not positive definite: conjugate gradients instead");
}

void SynchronousSolver::solve(Eigen::Ref<MatX> columns, Real) {
  assert(A_);
  if (ok_) {
    x_ = columns;
    factor_->solve(x_);
    for (Index c = 0; c < columns.cols(); ++c) {
      in_ = x_.col(c);
      A_->multiply(in_, out_);
      out_ = columns.col(c) - out_;
      in_ = columns.col(c);
      clear_fixed(fixed_, out_);
      clear_fixed(fixed_, in_);
      const Real scale = in_.norm();
      if (scale > 0) report_.residual = std::max(report_.residual, out_.norm() / scale);
    }
  } else {
    BlockJacobi jacobi;
    jacobi.compute(*A_, fixed_);
    const PcgReport r = pcg_.solve(*A_, fixed_, jacobi, columns, x_, 1e-6, 1000);
    report_.iterations += r.iterations;
    report_.residual = std::max(report_.residual, r.residual);
    report_.converged = report_.converged && r.converged;
    if (!r.converged) report_.complain("conjugate gradients did not converge");
  }
  columns = x_;
}

/// The matrix is factorised in every step; what lasts is the order in which that is done.
void SynchronousSolver::archive(Archive& a) {
  candidates_.archive(a);
  tissue::archive(a, report_);
  if (!a.restoring() || !a.ok()) return;
  plan_ = with_candidates(*plan_, candidates_.chosen());
  adopt_plan();
  ok_ = has_compliance_ = false;
}

NodeCompliance SynchronousSolver::compliance() const {
  if (!ok_ || candidates_of(*plan_).empty()) return {};
  if (!has_compliance_) factor_->candidate_compliance(compliance_);
  has_compliance_ = true;
  NodeCompliance out;
  out.see(compliance_, 3 * static_cast<Index>(candidates_of(*plan_).size()));
  out.number = number_;
  return out;
}

std::unique_ptr<TissueSolver> make_direct_solver(std::shared_ptr<Cache> cache) {
  auto out = std::make_unique<SynchronousSolver>();
  out->set_cache(std::move(cache));
  return out;
}

}  // namespace sutura::tissue
