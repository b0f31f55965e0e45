// Symmetric positive definite block tridiagonal systems with 6 x 6 blocks: the matrix of a chain.
//
// S_0 = D_0, S_{i+1} = D_{i+1} - C_i^T S_i^-1 C_i, T_i = S_i^-1 C_i      (block Thomas elimination)
// A solve is z_{i+1} = b_{i+1} - T_i^T z_i, then x_i = S_i^-1 z_i - T_i x_{i+1}.
//
// S^-1 is formed explicitly, through its 3 x 3 blocks (translations, rotations): no square roots,
// few dependent divisions, and block elimination without pivoting is exact under a scaling of each
// 3 x 3 block, so the two kinds of unit never meet. The blocks of the inverse follow from S^-1 and
// T:
//   G_nn = S_n^-1, G_ii = S_i^-1 + T_i G_{i+1,i+1} T_i^T, G_ij = -T_i G_{i+1,j} for i < j.
#pragma once

#include <vector>

#include "sutura/types.h"

namespace sutura::thread {

class BlockTridiagonal {
 public:
  void resize(Index blocks);
  /// Room for so many blocks: up to it, resize allocates nothing.
  void reserve(Index blocks);
  Index blocks() const { return static_cast<Index>(diagonal_.size()); }

  /// Fill these, then call factor(); they are kept, so that a residual can be computed.
  Mat6& diagonal(Index i) { return diagonal_[i]; }
  /// A(i, i+1)
  Mat6& upper(Index i) { return upper_[i]; }
  const Mat6& diagonal(Index i) const { return diagonal_[i]; }
  const Mat6& upper(Index i) const { return upper_[i]; }
  void set_zero();
  /// Row and column of one dof (0..5) of block i become those of the identity.
  void fix(Index i, Index dof);

  /// False if the matrix is not positive definite (or not finite); the factor is then useless.
  /// `indefinite`: any regular pivots will do (no pivoting; for Newton at an unstable equilibrium).
  bool factor(bool indefinite = false);
  /// After factor() found no positive definite matrix: some x with x^T A x < 0, or one that is not
  /// finite. `scale` of a block's first and last three dofs against each other (a length).
  void negative_direction(Real scale, Eigen::Ref<VecX> x) const;

  /// x <- A^-1 x; size 6 blocks(). No allocation.
  void solve(Eigen::Ref<VecX> x) const;
  /// Each column <- A^-1 column; several columns go through one matrix product.
  void solve(Eigen::Ref<MatX> columns) const;
  /// y = A x
  void multiply(const Eigen::Ref<const VecX>& x, Eigen::Ref<VecX> y) const;

  /// The inverse between some nodes (ascending), in O(blocks): own[a] = A^-1(nodes[a], nodes[a]),
  /// and A^-1(nodes[a], nodes[b]) = transfer[a] transfer[a+1] ... transfer[b-1] own[b] for a < b.
  void condense(const std::vector<Index>& nodes, std::vector<Mat6>& own,
                std::vector<Mat6>& transfer) const;

  std::size_t bytes_per_block() const { return 4 * sizeof(Mat6); }

 private:
  std::vector<Mat6> diagonal_, upper_, inverse_, transfer_;  // D, C, S^-1, T
  Mat6 pivot_ = Mat6::Zero();  ///< S of the block at which factor() ended
  Index pivot_block_ = 0;
};

}  // namespace sutura::thread
