#include "solve/compliance.h"

namespace sutura {

void Compliance::prepare(const ConstraintProblem& problem) {
  diagonal_.clear();
  offset_.clear();
  for (const ConstraintBlock& b : problem.blocks) {
    offset_.push_back(diagonal_.size());
    for (Index j = 0; j < b.law->dim; ++j)
      for (Index k = 0; k < b.law->dim; ++k)
        diagonal_.push_back(problem.W(b.first_row + k, b.first_row + j));
  }
}

void Compliance::keep(std::span<const std::size_t> blocks) {
  for (std::size_t i = 0; i < blocks.size(); ++i) offset_[i] = offset_[blocks[i]];
  offset_.resize(blocks.size());
}

void Compliance::update_delta(ConstraintProblem& problem) const {
  problem.delta = problem.d_free;
  problem.delta.noalias() += problem.W * problem.lambda;
}

void Compliance::add_change(ConstraintProblem& problem, std::size_t block,
                            const Real* change) const {
  const ConstraintBlock& b = problem.blocks[block];
  // By columns: W is symmetric and stored by columns.
  for (int k = 0; k < b.law->dim; ++k)
    if (change[k] != 0) problem.delta += change[k] * problem.W.col(b.first_row + k);
}

void Compliance::add_products(const ConstraintProblem& problem,
                              std::span<const RowCombination> combinations, bool symmetric,
                              Eigen::Ref<MatX> matrix) {
  column_.resize(problem.rows());
  // Most combinations are single rows.
  weights_.clear();
  first_weight_.clear();
  for (const RowCombination& c : combinations) {
    const ConstraintBlock& b = problem.blocks[c.block];
    first_weight_.push_back(weights_.size());
    for (int k = 0; k < b.law->dim; ++k)
      if (c.test[k] != 0) weights_.push_back({b.first_row + k, c.test[k]});
  }
  first_weight_.push_back(weights_.size());
  for (std::size_t j = 0; j < combinations.size(); ++j) {
    const RowCombination& cj = combinations[j];
    const ConstraintBlock& bj = problem.blocks[cj.block];
    column_.setZero();
    for (int k = 0; k < bj.law->dim; ++k)
      if (cj.move[k] != 0) column_ += cj.move[k] * problem.W.col(bj.first_row + k);
    for (std::size_t i = symmetric ? j : 0; i < combinations.size(); ++i) {
      Real g = 0;
      for (std::size_t e = first_weight_[i]; e < first_weight_[i + 1]; ++e)
        g += weights_[e].value * column_[weights_[e].row];
      matrix(combinations[i].at, cj.at) += g;
    }
  }
}

}  // namespace sutura
