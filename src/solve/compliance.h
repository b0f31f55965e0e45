// What the solvers ask of W beside its entries: blocks on the diagonal, products, and combinations
// of rows.
#pragma once

#include <span>
#include <vector>

#include "sutura/constraints.h"

namespace sutura {

/// A combination of the rows of one block: the force `move` on them, and the weights `test` with
/// which their displacement is seen. Pointers to as many numbers as the block has rows.
struct RowCombination {
  std::size_t block;
  const Real* move;
  const Real* test;
  Index at;  ///< row and column in the matrix of products
};

class Compliance {
 public:
  /// For the solves of one problem.
  void prepare(const ConstraintProblem& problem);
  /// For those of its blocks alone (ascending), each with the compliance that it has there.
  void keep(std::span<const std::size_t> blocks);

  /// The block of W on the diagonal, packed, so that a law gets a contiguous matrix: dim x dim,
  /// column major.
  const Real* operator[](std::size_t block) const { return &diagonal_[offset_[block]]; }

  /// delta <- W lambda + d_free, all rows.
  void update_delta(ConstraintProblem& problem) const;
  /// delta, all rows, after lambda of one block has changed by `change`.
  void add_change(ConstraintProblem& problem, std::size_t block, const Real* change) const;

  /// matrix(at_i, at_j) += test_i^T W move_j; `symmetric` (test = move everywhere): the lower
  /// triangle only.
  void add_products(const ConstraintProblem& problem, std::span<const RowCombination> combinations,
                    bool symmetric, Eigen::Ref<MatX> matrix);

 private:
  std::vector<Real> diagonal_;
  std::vector<std::size_t> offset_;
  GrowingVec column_;
  struct Weight {
    Index row;
    Real value;
  };
  std::vector<Weight> weights_;  // of the tests of combinations
  std::vector<std::size_t> first_weight_;
};

}  // namespace sutura
