// What the solvers ask of W, whatever it is made of: assembled bodies in problem.W, chains as
// operators. One scene mixes them. No virtual call: a problem without operators takes the columns
// of W as they lie, one with operators asks those few in turn.
#pragma once

#include <span>
#include <vector>

#include "solve/chain_operator.h"
#include "sutura/constraints.h"

namespace sutura {

class Compliance {
 public:
  /// For the solves of one problem, which must stay where it is.
  void prepare(const ConstraintProblem& problem);
  bool has_operators() const { return operators_ > 0; }

  /// The block of W on the diagonal, packed, so that a law gets a contiguous matrix: dim x dim,
  /// column major.
  const Real* operator[](std::size_t block) const { return &diagonal_[offset_[block]]; }

  /// delta <- W lambda + d_free, all rows.
  void update_delta(ConstraintProblem& problem);

  /// A sweep visits blocks in any order, between begin and end. delta of problem is whole outside
  /// of that, and at its beginning must belong to lambda.
  void begin_sweep();
  /// delta of one block as it is now.
  void displacement(const ConstraintProblem& problem, std::size_t block, Real* delta);
  /// lambda of one block has changed by `change`.
  void add_change(ConstraintProblem& problem, std::size_t block, const Real* change);
  void end_sweep(ConstraintProblem& problem);

  /// matrix(at_i, at_j) += test_i^T W move_j; `symmetric` (test = move everywhere): the lower
  /// triangle only.
  void add_products(const ConstraintProblem& problem, std::span<const RowCombination> combinations,
                    bool symmetric, Eigen::Ref<MatX> matrix);

  std::span<const ChainOperator> operators() const { return {chains_.data(), operators_}; }

 private:
  void add_assembled_products(const ConstraintProblem& problem,
                              std::span<const RowCombination> combinations, bool symmetric,
                              Eigen::Ref<MatX> matrix);

  std::vector<Real> diagonal_;
  std::vector<std::size_t> offset_;
  std::vector<char> in_W_;             // per block: some assembled body has rows of it
  Index first_row_ = 0, rows_ = 0;     // outside of which W is zero
  std::vector<ChainOperator> chains_;  // the first operators_ are those of this problem
  std::size_t operators_ = 0;
  VecX assembled_delta_, column_;
  struct Weight {
    Index row;
    Real value;
  };
  std::vector<Weight> weights_;  // of the tests of combinations
  std::vector<std::size_t> first_weight_;
};

/// W(j, i) <- W(i, j) for i > j.
void mirror_lower_triangle(MatX& W);

/// W of all bodies, assembled.
MatX assembled_compliance(const ConstraintProblem& problem);

}  // namespace sutura
