// The compliance of one chain as an operator: W_chain lambda, row by row, without W_chain.
// docs/theory/solver.md.
//
// With F_a the force (6) at touched node a, the displacement there is u_a = own_a (F_a + phi_a) +
// beta_a,
//   phi_a  = sum_{b<a} (transfer_b ... transfer_{a-1})^T F_b      what arrives from the left, a
//   force beta_a = sum_{b>a} transfer_a ... transfer_{b-1} own_b F_b    what arrives from the
//   right, a motion
// A balanced binary tree over the touched nodes keeps, for every stretch of them, the product of
// its transfers and the two messages that it sends: a change of F_a renews one message per level,
// u_a gathers one per level. Visiting a block costs O(log t), in any order of blocks, and does not
// know how many beams the chain has.
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

/// Used in this order: prepare; diagonal and products, any time; multiply, begin_sweep, visits;
/// multiply again.
class ChainOperator {
 public:
  /// Takes the chain of this step (kept by reference) and the rows H of its body.
  void prepare(const ConstraintProblem& problem, const ChainCompliance& chain,
               const BodyRows& rows);
  bool touches(std::size_t block) const { return blocks_[block].slots > 0; }

  /// W += the block of W_chain on the diagonal; dim x dim, column major.
  void add_diagonal(std::size_t block, Real* W);
  /// delta += W_chain lambda, all rows, in O(t). Sets the forces F for the visits that follow.
  void multiply(const VecX& lambda, VecX& delta);
  /// matrix(at_i, at_j) += test_i^T W_chain move_j over all pairs. `symmetric` says that test =
  /// move everywhere and asks for the lower triangle only, at_i >= at_j.
  void add_products(std::span<const RowCombination> combinations, bool symmetric,
                    Eigen::Ref<MatX> matrix);

  /// The lower triangle of W += that of W_chain.
  void add_lower_triangle(Eigen::Ref<MatX> W);

  /// Before the visits of a sweep, after multiply.
  void begin_sweep();
  /// delta (dim) += W_chain lambda, on the rows of one block.
  void add_displacement(std::size_t block, Real* delta);
  /// lambda of one block changes by `change` (dim).
  void add_force(std::size_t block, const Real* change);

  /// Products of a 6 x 6 block with a vector since this object was made: what a visit costs,
  /// counted.
  Index products() const { return products_; }

 private:
  struct BlockRows {
    Index first_row = 0;
    int dim = 0, slots = 0;       // a slot is a node that the block touches
    std::size_t first_slot = 0;   // slots ascend along the chain
    std::size_t first_value = 0;  // dim coefficient vectors per slot
  };
  struct Message {
    Vec6 force;   // of a stretch: its share of phi just right of it
    Vec6 motion;  // its share of beta, plus own F, at its left end
  };
  struct Climb {
    std::size_t at;
    Message change;
  };
  // A row per force: what is done to all of them is a vector operation.
  using Panel = Eigen::Matrix<Real, 4, 6>;

  void read_block(const ConstraintBlock& block, const BodyRows& rows, std::size_t& row);
  void build_tree();
  /// v <- transfer[from] ... transfer[to - 1] v.
  void carry(Index from, Index to, Vec6& v);
  void combine(std::span<const RowCombination> combinations, bool moves,
               std::vector<Vec6>& vectors) const;
  /// Half of the products: what reaches nodes on the left of a force, and half of the force's own
  /// node.
  template <class Add>
  void left_products(std::span<const RowCombination> combinations, const std::vector<Vec6>& forces,
                     const std::vector<Vec6>& seen, const Add& add);

  const ChainCompliance* chain_ = nullptr;
  std::vector<BlockRows> blocks_;
  std::vector<Index> place_;          // per slot: index into the touched nodes
  std::vector<Vec6> value_;           // coefficients of H
  std::vector<Index> place_of_node_;  // -1 outside of prepare

  std::vector<Vec6> force_, motion_;  // F and u, per touched node

  // The tree: stretch 1 is all, 2 s and 2 s + 1 are the halves of s, leaves_ + a is the single node
  // a.
  std::size_t leaves_ = 1;
  int levels_ = 0;
  bool tree_built_ = false;
  std::vector<Mat6> across_;  // transfers of a stretch multiplied, from its right end to its left
  std::vector<Message> message_;
  std::vector<Message> outside_;  // per level: what arrives at the stretch on the way to a leaf
  std::vector<Climb> climb_;

  std::vector<Vec6> moved_, seen_;  // of add_products
  std::vector<RowCombination> rows_;
  std::vector<Panel> panel_;
  Index products_ = 0;
};

}  // namespace sutura
