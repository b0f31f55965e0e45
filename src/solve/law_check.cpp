#include "solve/law_check.h"

#include <algorithm>

namespace sutura {

void LawCheck::begin(ConstraintProblem& problem) {
  compliance_.prepare(problem);
  d_free_ = problem.d_free;
  problem.d_free.setZero();
  compliance_.update_delta(problem);
  problem.d_free = d_free_ - problem.delta;
  known_.clear();
  diagonal_.clear();
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    const int dim = problem.blocks[i].law->dim;
    known_.push_back({problem.blocks[i].key, diagonal_.size(), dim});
    const Real* W = compliance_[i];
    diagonal_.insert(diagonal_.end(), W, W + dim * dim);
  }
  std::sort(known_.begin(), known_.end(),
            [](const Known& a, const Known& b) { return a.key < b.key; });
}

LawCheck::Miss LawCheck::measure(ConstraintProblem& problem, Real tolerance) {
  Miss worst;
  for (ConstraintBlock& b : problem.blocks) {
    const int dim = b.law->dim;
    Real W[max_block_dim * max_block_dim] = {};
    const auto it = std::lower_bound(known_.begin(), known_.end(), b.key,
                                     [](const Known& k, const Key& key) { return k.key < key; });
    if (it != known_.end() && it->key == b.key && it->dim == dim)
      std::copy_n(&diagonal_[it->first], dim * dim, W);
    else
      for (int k = 0; k < dim; ++k) W[k * (dim + 1)] = b.units.length / b.units.force;
    Real plus[max_block_dim];
    Mode mode = b.mode;
    worst.ask(problem, b, W, mode, plus);
    const Real relative = b.violation / std::min(tolerance, b.precision);
    if (!(relative <= worst.relative)) worst.relative = relative;  // a NaN stays
  }
  return worst;
}

}  // namespace sutura
