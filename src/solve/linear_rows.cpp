#include "solve/linear_rows.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string_view>

#include "sutura/laws/bilateral.h"

namespace sutura {

namespace {

/// The compliance of a block that is held without a cap, else a negative number. (Bilateral laws of
/// all sizes have the same parameters; a law is known by its name, plugins have copies of it.)
template <int N>
Real held_compliance(const ConstraintProblem& problem, const ConstraintBlock& b) {
  if (std::string_view(b.law->name) != Bilateral<N>::name) return -1;
  const auto& p = *static_cast<const typename Bilateral<N>::Params*>(problem.block_params(b));
  return std::isfinite(p.cap) ? -1 : p.compliance;
}

Real held_compliance(const ConstraintProblem& problem, const ConstraintBlock& b) {
  return std::max({held_compliance<1>(problem, b), held_compliance<2>(problem, b),
                   held_compliance<3>(problem, b), held_compliance<6>(problem, b)});
}

}  // namespace

bool LinearRows::find(const ConstraintProblem& problem, bool with_turning) {
  other_.clear();
  rows_.clear();
  other_rows_.clear();
  turning_.clear();
  compliance_.setZero(problem.rows());
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    const ConstraintBlock& b = problem.blocks[i];
    if (with_turning && std::string_view(b.law->name) == TurningForce::name) {
      turning_.push_back(i);
      continue;
    }
    const Real compliance = held_compliance(problem, b);
    if (compliance < 0) other_.push_back(i);
    for (Index row = b.first_row; row < b.first_row + b.law->dim; ++row) {
      if (compliance >= 0) compliance_[static_cast<Index>(rows_.size())] = compliance;
      (compliance >= 0 ? rows_ : other_rows_).push_back(row);
    }
  }
  // A force that turns has a positive and a negative pivot, in this order, where all is stable.
  for (const std::size_t i : turning_) rows_.push_back(problem.blocks[i].first_row);
  positive_ = static_cast<Index>(rows_.size());
  for (const std::size_t i : turning_) rows_.push_back(problem.blocks[i].first_row + 1);
  held_ = static_cast<Index>(rows_.size());
  rows_.insert(rows_.end(), other_rows_.begin(), other_rows_.end());
  return held_ > 0 && (!other_rows_.empty() || !turning_.empty());
}

void LinearRows::set_mode(ConstraintProblem& problem, Mode mode) const {
  for (const std::size_t i : turning_) problem.blocks[i].mode = mode;
}

/// matrix_ <- [S (W_hh + C) S, .; W_oh S, W_oo; d_h^T S, d_o^T], its lower part.
void LinearRows::gather(const ConstraintProblem& problem) {
  const auto n = static_cast<Index>(rows_.size());
  const auto row = [this](Index i) { return rows_[static_cast<std::size_t>(i)]; };
  matrix_.resize(n + 1, n + 1);
  for (Index j = 0; j < n; ++j) {
    for (Index i = j; i < n; ++i) matrix_(i, j) = problem.W(row(i), row(j));
    matrix_(n, j) = problem.d_free[row(j)];
  }
  coupling_.resize(held_ - positive_);
  for (Index row = positive_; row < held_; ++row) {
    const ConstraintBlock& b = problem.blocks[turning_[static_cast<std::size_t>(row - positive_)]];
    const BlockMatrix<2> compliance = TurningForce::compliance(
        *static_cast<const TurningForce::Params*>(problem.block_params(b)));
    coupling_[row - positive_] = compliance(1, 0);
    compliance_[row] = compliance(1, 1);
    matrix_(row, row - (held_ - positive_)) += compliance(1, 0);
    matrix_(row, row) += compliance(1, 1);
  }
  scale_.resize(held_);
  for (Index j = 0; j < held_; ++j) {
    const Real more = j < positive_ ? compliance_[j] : coupling_[j - positive_];
    scale_[j] = 1 / std::sqrt(std::abs(matrix_(j, j)) + more);
    matrix_(j, j) = j < positive_ ? 1 : matrix_(j, j) * scale_[j] * scale_[j];
    matrix_.col(j).tail(n - j) *= scale_[j];
    matrix_.row(j).head(j) *= scale_[j];
  }
}

/// Cholesky of the first columns, and what that leaves of the others; of minus the matrix where
/// pivots are negative. In panels so narrow that Eigen's products take no memory from the heap (128
/// kB) up to some 650 rows.
bool LinearRows::factorise() {
  constexpr Index width = 24;
  const Index size = matrix_.rows();
  for (Index first = 0, columns = 0; first < held_; first += columns) {
    const bool positive = first < positive_;
    const Real sign = positive ? 1 : -1;
    columns = std::min(width, (positive ? positive_ : held_) - first);
    const Index rest = size - first - columns;
    Eigen::Ref<MatX> in_place = matrix_.block(first, first, columns, columns);
    in_place *= sign;
    const Eigen::LLT<Eigen::Ref<MatX>> corner(in_place);
    // The diagonal of L^2 is what is a row's own, beside those before it.
    constexpr Real least = 1e-12;
    const auto diagonal = matrix_.diagonal().segment(first, columns);
    if (corner.info() != Eigen::Success || !(diagonal.minCoeff() > std::sqrt(least))) return false;
    auto below = matrix_.block(first + columns, first, rest, columns);
    corner.matrixU().solveInPlace<Eigen::OnTheRight>(below);
    below *= sign;
    matrix_.bottomRightCorner(rest, rest).selfadjointView<Eigen::Lower>().rankUpdate(below, -sign);
  }
  return true;
}

bool LinearRows::eliminate(ConstraintProblem& problem, ConstraintProblem& others) {
  const auto succeeds = [&] {
    gather(problem);
    return scale_.allFinite() && factorise();
  };
  if (!succeeds()) {
    if (turning_.empty()) return false;
    give_up(problem);
    if (!find(problem, false) || !succeeds()) return false;
  }
  set_mode(problem, TurningForce::whole);

  const auto o = static_cast<Index>(rows_.size()) - held_;
  others.blocks.clear();
  others.params = problem.params;
  Index row = 0;
  for (const std::size_t i : other_) {
    others.blocks.push_back(problem.blocks[i]);
    others.blocks.back().first_row = row;
    row += problem.blocks[i].law->dim;
  }
  others.gap.setZero(o);
  others.delta.setZero(o);
  others.lambda.resize(o);
  for (Index i = 0; i < o; ++i)
    others.lambda[i] = problem.lambda[rows_[static_cast<std::size_t>(held_ + i)]];
  others.d_free = matrix_.row(held_ + o).segment(held_, o).transpose();
  others.W.resize(o, o);
  others.W.triangularView<Eigen::Lower>() = matrix_.block(held_, held_, o, o);
  others.W.triangularView<Eigen::StrictlyUpper>() = others.W.transpose();
  before_.setZero(held_);
  return true;
}

void LinearRows::put_back(const ConstraintProblem& others, ConstraintProblem& problem) {
  for (std::size_t i = 0; i < other_.size(); ++i)
    problem.blocks[other_[i]].mode = others.blocks[i].mode;
  const Index o = others.lambda.size();
  force_ = matrix_.row(held_ + o).head(held_).transpose();
  force_.noalias() += matrix_.block(held_, 0, o, held_).transpose() * others.lambda;
  matrix_.topLeftCorner(held_, held_)
      .triangularView<Eigen::Lower>()
      .transpose()
      .solveInPlace(force_);
  force_.array() *= -scale_.array();
  for (Index i = 0; i < held_ + o; ++i)
    problem.lambda[rows_[static_cast<std::size_t>(i)]] =
        i < held_ ? before_[i] + force_[i] : others.lambda[i - held_];
}

/// What held rows leave is delta + C lambda. It takes the place of d_h, and delta that of d_o.
void LinearRows::refine(const ConstraintProblem& problem, ConstraintProblem& others) {
  const Index o = others.lambda.size(), turning = held_ - positive_;
  const auto row = [this](Index i) { return rows_[static_cast<std::size_t>(i)]; };
  for (Index i = 0; i < held_; ++i) {
    before_[i] = problem.lambda[row(i)];
    force_[i] = problem.delta[row(i)] + compliance_[i] * before_[i];
  }
  for (Index i = positive_; i < held_; ++i) {
    force_[i] += coupling_[i - positive_] * before_[i - turning];
    force_[i - turning] += coupling_[i - positive_] * before_[i];
  }
  force_.array() *= scale_.array();
  matrix_.topLeftCorner(held_, held_).triangularView<Eigen::Lower>().solveInPlace(force_);
  const auto below = matrix_.block(held_, 0, o, held_);
  for (Index i = 0; i < o; ++i) others.d_free[i] = problem.delta[row(held_ + i)];
  others.d_free.noalias() -= below * force_;
  others.d_free.noalias() -= others.W * others.lambda;
  force_.tail(turning) *= -1;
  force_.noalias() -= below.transpose() * others.lambda;
  matrix_.row(held_ + o).head(held_) = force_.transpose();
}

}  // namespace sutura
