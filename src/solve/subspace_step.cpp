#include "solve/subspace_step.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace sutura {

namespace {

/// Directions from which on a device is faster than the CPU (docs/theory/opencl.md).
constexpr Index worth_a_device = 100;

/// The share of its own compliance by which each row is softened that may repeat others, at this
/// law residual. Most forces of such rows are determined badly or not at all, and would run away
/// before the states are right.
Real damping(Real residual) {
  constexpr Real most = 2e-3;
  const Real root = std::sqrt(std::min(residual, Real(1)));
  return most * root * std::sqrt(root);  // residual^0.75: faster than linear at the end
}

}  // namespace

void SubspaceStep::begin(SweepDevice* device) {
  factored_ = false;
  device_ = device;
}

void SubspaceStep::ask(const ConstraintProblem& problem, Compliance& compliance) {
  asked_.resize(problem.rows());
  asked_delta_.resize(problem.rows());
  asked_state_.resize(problem.blocks.size());
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    const ConstraintBlock& b = problem.blocks[i];
    const int dim = b.law->dim;
    Real mean = 0;
    for (int k = 0; k < dim; ++k) mean += compliance[i][k + k * dim] / dim;
    Real D[max_block_dim * max_block_dim] = {}, d[max_block_dim];
    for (int k = 0; k < dim; ++k) {
      const Index row = b.first_row + k;
      D[k + k * dim] = mean;
      d[k] = problem.delta[row] - mean * problem.lambda[row];
      asked_[row] = problem.lambda[row];
    }
    asked_state_[i] = b.mode;
    b.law->project({D, d, problem.block_params(b), &asked_state_[i], asked_.data() + b.first_row});
    for (int k = 0; k < dim; ++k)
      asked_delta_[b.first_row + k] = d[k] + mean * asked_[b.first_row + k];
  }
}

void SubspaceStep::take_tangent(const ConstraintProblem& problem, Compliance& compliance,
                                std::size_t block) {
  const ConstraintBlock& b = problem.blocks[block];
  Real plus[max_block_dim];
  for (int k = 0; k < b.law->dim; ++k) base_[b.first_row + k] = plus[k] = asked_[b.first_row + k];
  Mode mode = asked_state_[block];
  b.law->free_directions(
      {compliance[block], asked_delta_.data() + b.first_row, problem.block_params(b), &mode, plus},
      tangents_[block]);
  states_[block] = asked_state_[block];
}

Index SubspaceStep::gather(const ConstraintProblem& problem, Compliance& compliance) {
  tangents_.resize(problem.blocks.size());
  states_.resize(problem.blocks.size());
  base_.resize(problem.rows());
  ask(problem, compliance);
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) take_tangent(problem, compliance, i);
  collect(problem);
  return static_cast<Index>(now_.directions.size());
}

std::size_t SubspaceStep::change_states(const ConstraintProblem& problem, Compliance& compliance,
                                        std::size_t most) {
  ask(problem, compliance);
  changing_.clear();
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    if (asked_state_[i] != states_[i])
      changing_.push_back(i);
    else
      take_tangent(problem, compliance, i);
  }
  const std::size_t count = changing_.size();
  if (most < count) {
    const auto end = changing_.begin() + static_cast<std::ptrdiff_t>(most);
    std::nth_element(changing_.begin(), end, changing_.end(), [&](std::size_t a, std::size_t b) {
      return block_residual_[a] > block_residual_[b] ||
             (block_residual_[a] == block_residual_[b] && a < b);
    });
    changing_.erase(end, changing_.end());
  }
  for (const std::size_t i : changing_) take_tangent(problem, compliance, i);
  return count;
}

void SubspaceStep::collect(const ConstraintProblem& problem) {
  now_.entries.clear();
  now_.directions.clear();
  now_.compliance.clear();
  symmetric_ = true;
  gap_.resize(problem.rows());
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    const ConstraintBlock& b = problem.blocks[i];
    const int dim = b.law->dim;
    const FreeDirectionsView& free = tangents_[i];
    for (int j = 0; j < free.count; ++j) {
      Direction direction{now_.entries.size(), 0, i, j};
      for (int k = 0; k < dim; ++k) {
        const Entry entry{b.first_row + k, free.move[k + j * dim], free.test[k + j * dim]};
        if (entry.move != 0 || entry.test != 0) now_.entries.push_back(entry);
        if (entry.move != entry.test) symmetric_ = false;
      }
      direction.end = now_.entries.size();
      gap_[static_cast<Index>(now_.directions.size())] = free.gap[j];
      now_.directions.push_back(direction);
      for (int k = 0; k < max_block_dim; ++k)
        now_.compliance.push_back(k < free.count ? free.compliance[k + j * dim] : Real(0));
    }
  }
}

Real SubspaceStep::left_of(const ConstraintProblem& problem, Index direction) const {
  const Direction& d = now_.directions[static_cast<std::size_t>(direction)];
  Real r = gap_[direction];
  for (std::size_t e = d.first; e < d.end; ++e)
    r += now_.entries[e].test * problem.delta[now_.entries[e].row];
  return r;
}

void SubspaceStep::assemble(const ConstraintProblem& problem, Compliance& compliance) {
  const auto f = static_cast<Index>(now_.directions.size());
  if (matrix_.rows() < f) matrix_.resize(f, f);
  auto G = matrix_.topLeftCorner(f, f);
  G.setZero();
  combinations_.clear();
  for (Index j = 0; j < f; ++j) {
    const Direction& d = now_.directions[static_cast<std::size_t>(j)];
    const FreeDirectionsView& tangent = tangents_[d.block];
    const int first = d.index * problem.blocks[d.block].law->dim;
    combinations_.push_back({d.block, tangent.move + first, tangent.test + first, j});
    const Index first_of_block = j - d.index;  // directions of one block are consecutive
    for (int i = symmetric_ ? d.index : 0; i < tangent.count; ++i)
      G(first_of_block + i, j) += now_.compliance[static_cast<std::size_t>(j) * max_block_dim +
                                                  static_cast<std::size_t>(i)];
  }
  compliance.add_products(problem, combinations_, symmetric_, G);
}

Real SubspaceStep::damping_of(const ConstraintProblem& problem, Index direction) const {
  const Direction& d = now_.directions[static_cast<std::size_t>(direction)];
  return problem.blocks[d.block].redundant ? damping_ : undamped;
}

bool SubspaceStep::factorise(const ConstraintProblem& problem) {
  const auto f = static_cast<Index>(now_.directions.size());
  auto G = matrix_.topLeftCorner(f, f);
  // Unit diagonal: rows of different compliance weigh the same, and damping is relative to each.
  // Repeating the step corrects what it leaves.
  scale_.resize(f);
  for (Index i = 0; i < f; ++i)
    scale_[i] = G(i, i) != 0 ? 1 / std::sqrt(std::abs(G(i, i))) : Real(1);
  if (!scale_.allFinite()) return false;
  G.array().colwise() *= scale_.array();
  G.array().rowwise() *= scale_.transpose().array();
  for (Index i = 0; i < f; ++i) G(i, i) += damping_of(problem, i);
  if (symmetric_) {
    Eigen::Ref<MatX, 0, Eigen::OuterStride<>> in_place(G);
    Eigen::LLT<Eigen::Ref<MatX, 0, Eigen::OuterStride<>>> llt(in_place);
    return llt.info() == Eigen::Success;
  }
  // As Eigen::PartialPivLU does it, in our own memory.
  LU_ = G;
  swaps_.resize(static_cast<std::size_t>(f));
  int count = 0;
  Eigen::internal::partial_lu_impl<Real, Eigen::ColMajor, int>::blocked_lu(f, f, LU_.data(), f,
                                                                           swaps_.data(), count);
  return true;
}

/// lambda <- base + move y.
void SubspaceStep::apply(ConstraintProblem& problem) const {
  for (Index j = 0; j < y_.size(); ++j) {
    const Direction& d = now_.directions[static_cast<std::size_t>(j)];
    for (std::size_t e = d.first; e < d.end; ++e)
      problem.lambda[now_.entries[e].row] += now_.entries[e].move * y_[j];
  }
}

bool SubspaceStep::solve_here(ConstraintProblem& problem, Compliance& compliance,
                              SolveReport& report) {
  const auto f = static_cast<Index>(now_.directions.size());
  compliance.update_delta(problem);
  if (!unchanged()) {
    assemble(problem, compliance);
    ++report.factorisations;
    factored_ = factorise(problem);
    if (!factored_) return false;
    factored_with_ = now_;
    factored_damping_ = damping_;
  }
  y_.resize(f);
  for (Index j = 0; j < f; ++j) y_[j] = -left_of(problem, j) * scale_[j];
  asked_of_system_ = y_.lpNorm<Eigen::Infinity>();
  if (symmetric_) {
    const auto L = matrix_.topLeftCorner(f, f);
    L.triangularView<Eigen::Lower>().solveInPlace(y_);
    L.transpose().triangularView<Eigen::Upper>().solveInPlace(y_);
  } else {
    for (Index i = 0; i < f; ++i) std::swap(y_[i], y_[swaps_[static_cast<std::size_t>(i)]]);
    LU_.triangularView<Eigen::UnitLower>().solveInPlace(y_);
    LU_.triangularView<Eigen::Upper>().solveInPlace(y_);
  }
  y_.array() *= scale_.array();
  apply(problem);
  compliance.update_delta(problem);
  return true;
}

/// Rows that contradict each other have no solution; what rounding makes of one is huge and must
/// not be taken. What damping leaves is for the next step.
bool SubspaceStep::is_solved(const ConstraintProblem& problem) const {
  Real left = 0;
  for (Index j = 0; j < y_.size(); ++j) {
    if (damping_of(problem, j) > undamped) continue;
    const Direction& d = now_.directions[static_cast<std::size_t>(j)];
    Real r = left_of(problem, j);
    const Index first = j - d.index;  // directions of one block are consecutive
    for (int k = 0; k < tangents_[d.block].count; ++k)
      r += now_.compliance[static_cast<std::size_t>(first + k) * max_block_dim +
                           static_cast<std::size_t>(d.index)] *
           y_[first + k];
    left = std::max(left, std::abs(r) * scale_[j]);
  }
  return problem.lambda.allFinite() && left <= 1e-2 * asked_of_system_;
}

bool SubspaceStep::solve(ConstraintProblem& problem, Compliance& compliance, SolveReport& report) {
  const auto f = static_cast<Index>(now_.directions.size());
  problem.lambda = base_;
  if (f == 0) {
    compliance.update_delta(problem);
    return true;
  }
  if (device_ != nullptr && f >= worth_a_device && solve_on_device(problem)) {
    factored_ = false;  // nothing of this is kept
    ++report.factorisations;
    if (is_solved(problem)) return true;
    problem.lambda = base_;  // there, rows are not exchanged
  }
  return solve_here(problem, compliance, report) && is_solved(problem);
}

Residual SubspaceStep::newton(ConstraintProblem& problem, Compliance& compliance, Residual residual,
                              Real tolerance, GrowingVec& lambda_plus, SolveReport& report,
                              bool may_walk) {
  constexpr int patience = 40;  // steps without fewer blocks in the wrong state
  const GrowingVec& start = start_lambda_ = problem.lambda;
  best_ = residual;
  best_lambda_ = problem.lambda;
  gather(problem, compliance);
  std::size_t fewest = problem.blocks.size(), most = fewest;
  damping_ = damping(1);
  for (int idle = 0; idle < patience && residual.value > tolerance; ++idle) {
    if (!solve(problem, compliance, report)) break;
    ++report.direct_solves;
    residual = natural_map(problem, compliance, lambda_plus, &block_residual_);
    if (!std::isfinite(residual.value)) break;
    keep_best(problem, residual);
    if (!(residual.value > tolerance)) return residual;  // lambda and delta are those of the best
    damping_ = std::max(damping(residual.value), undamped);
    const std::size_t wrong = change_states(problem, compliance, most);
    collect(problem);
    if (wrong < fewest) {
      fewest = wrong;
      idle = 0;
    } else {
      most = std::max(std::min(most, wrong) * 2 / 3, std::size_t{1});
    }
  }
  if (may_walk && best_.value > tolerance) {
    problem.lambda = start;
    compliance.update_delta(problem);
    walk(problem, compliance, tolerance, lambda_plus, report);
  }
  problem.lambda = best_lambda_;
  compliance.update_delta(problem);
  return natural_map(problem, compliance, lambda_plus);
}

void SubspaceStep::keep_best(const ConstraintProblem& problem, const Residual& residual) {
  if (!(residual.value < best_.value)) return;
  best_ = residual;
  best_lambda_ = problem.lambda;
}

}  // namespace sutura
