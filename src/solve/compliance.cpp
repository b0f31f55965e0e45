#include "solve/compliance.h"

#include <algorithm>

namespace sutura {

void Compliance::prepare(const ConstraintProblem& problem) {
  operators_ = 0;
  for (std::size_t i = 0; i < problem.chains.size(); ++i) {
    if (problem.chains[i].empty()) continue;
    if (chains_.size() == operators_) chains_.emplace_back();
    chains_[operators_++].prepare(problem, problem.chains[i], problem.bodies[i]);
  }

  // Which part of W is not zero: all of it unless bodies with rows are kept out of it.
  in_W_.assign(problem.blocks.size(), operators_ == 0);
  if (operators_ > 0)
    for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
      if (!problem.chains[i].empty()) continue;
      std::size_t block = 0;
      for (const Index row : problem.bodies[i].row) {
        while (block + 1 < problem.blocks.size() && problem.blocks[block + 1].first_row <= row)
          ++block;
        in_W_[block] = true;
      }
    }
  first_row_ = problem.rows();
  Index end = 0;
  diagonal_.clear();
  offset_.clear();
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    const ConstraintBlock& b = problem.blocks[i];
    const Index dim = b.law->dim;
    offset_.push_back(diagonal_.size());
    for (Index j = 0; j < dim; ++j)
      for (Index k = 0; k < dim; ++k)
        diagonal_.push_back(in_W_[i] ? problem.W(b.first_row + k, b.first_row + j) : Real(0));
    for (std::size_t o = 0; o < operators_; ++o) chains_[o].add_diagonal(i, &diagonal_[offset_[i]]);
    if (!in_W_[i]) continue;
    first_row_ = std::min(first_row_, b.first_row);
    end = std::max(end, b.first_row + dim);
  }
  rows_ = std::max(end - first_row_, Index{0});
}

void Compliance::update_delta(ConstraintProblem& problem) {
  VecX& delta = problem.delta;
  delta = problem.d_free;
  if (!has_operators()) {
    delta.noalias() += problem.W * problem.lambda;
    return;
  }
  delta.segment(first_row_, rows_).noalias() +=
      problem.W.block(first_row_, first_row_, rows_, rows_) *
      problem.lambda.segment(first_row_, rows_);
  assembled_delta_ = delta;
  for (std::size_t o = 0; o < operators_; ++o) chains_[o].multiply(problem.lambda, delta);
}

void Compliance::begin_sweep() {
  for (std::size_t o = 0; o < operators_; ++o) chains_[o].begin_sweep();
}

void Compliance::displacement(const ConstraintProblem& problem, std::size_t block, Real* delta) {
  const ConstraintBlock& b = problem.blocks[block];
  const VecX& known = has_operators() ? assembled_delta_ : problem.delta;
  std::copy_n(known.data() + b.first_row, b.law->dim, delta);
  for (std::size_t o = 0; o < operators_; ++o) chains_[o].add_displacement(block, delta);
}

void Compliance::add_change(ConstraintProblem& problem, std::size_t block, const Real* change) {
  const ConstraintBlock& b = problem.blocks[block];
  // By columns: W is symmetric and stored by columns.
  if (!has_operators()) {
    for (int k = 0; k < b.law->dim; ++k)
      if (change[k] != 0) problem.delta += change[k] * problem.W.col(b.first_row + k);
    return;
  }
  if (std::all_of(change, change + b.law->dim, [](Real c) { return c == 0; })) return;
  if (in_W_[block])
    for (int k = 0; k < b.law->dim; ++k)
      assembled_delta_.segment(first_row_, rows_) +=
          change[k] * problem.W.col(b.first_row + k).segment(first_row_, rows_);
  for (std::size_t o = 0; o < operators_; ++o) chains_[o].add_force(block, change);
}

void Compliance::end_sweep(ConstraintProblem& problem) {
  if (!has_operators()) return;
  problem.delta = assembled_delta_;
  for (std::size_t o = 0; o < operators_; ++o) chains_[o].multiply(problem.lambda, problem.delta);
}

void Compliance::add_assembled_products(const ConstraintProblem& problem,
                                        std::span<const RowCombination> combinations,
                                        bool symmetric, Eigen::Ref<MatX> matrix) {
  const Index n = problem.rows();
  if (column_.size() < n) column_.resize(n);
  auto w = column_.head(n);
  // Most combinations are single rows.
  weights_.clear();
  first_weight_.clear();
  for (const RowCombination& c : combinations) {
    const ConstraintBlock& b = problem.blocks[c.block];
    first_weight_.push_back(weights_.size());
    for (int k = 0; k < b.law->dim && in_W_[c.block]; ++k)
      if (c.test[k] != 0) weights_.push_back({b.first_row + k, c.test[k]});
  }
  first_weight_.push_back(weights_.size());
  for (std::size_t j = 0; j < combinations.size(); ++j) {
    const RowCombination& cj = combinations[j];
    if (!in_W_[cj.block]) continue;
    const ConstraintBlock& bj = problem.blocks[cj.block];
    w.setZero();
    for (int k = 0; k < bj.law->dim; ++k)
      if (cj.move[k] != 0) w += cj.move[k] * problem.W.col(bj.first_row + k);
    for (std::size_t i = symmetric ? j : 0; i < combinations.size(); ++i) {
      Real g = 0;
      for (std::size_t e = first_weight_[i]; e < first_weight_[i + 1]; ++e)
        g += weights_[e].value * w[weights_[e].row];
      matrix(combinations[i].at, cj.at) += g;
    }
  }
}

void Compliance::add_products(const ConstraintProblem& problem,
                              std::span<const RowCombination> combinations, bool symmetric,
                              Eigen::Ref<MatX> matrix) {
  add_assembled_products(problem, combinations, symmetric, matrix);
  for (std::size_t o = 0; o < operators_; ++o)
    chains_[o].add_products(combinations, symmetric, matrix);
}

void mirror_lower_triangle(MatX& W) {
  // Eigen's triangular copy walks rows; by tiles it stays in the cache.
  constexpr Index tile = 16;
  const Index n = W.rows();
  for (Index j = 0; j < n; j += tile)
    for (Index i = j; i < n; i += tile)
      for (Index l = j; l < std::min(j + tile, n); ++l)
        for (Index k = std::max(i, l + 1); k < std::min(i + tile, n); ++k) W(l, k) = W(k, l);
}

MatX assembled_compliance(const ConstraintProblem& problem) {
  MatX chains = MatX::Zero(problem.rows(), problem.rows());
  ChainOperator chain;
  for (std::size_t i = 0; i < problem.chains.size(); ++i) {
    if (problem.chains[i].empty()) continue;
    chain.prepare(problem, problem.chains[i], problem.bodies[i]);
    chain.add_lower_triangle(chains);
  }
  mirror_lower_triangle(chains);
  if (problem.W.size() > 0) chains += problem.W;
  return chains;
}

}  // namespace sutura
