// The compliance of a chain of beams to its rows: W = h^2 H A^-1 H^T without a solve per row
// (docs/theory/solver.md).
#pragma once

#include <vector>

#include "block_tridiagonal.h"
#include "sutura/body.h"
#include "sutura/growing.h"

namespace sutura::thread {

/// G = h^2 A^-1 of a chain between some of its nodes. The inverse of a block tridiagonal matrix
/// needs two blocks per node, however many others lie between: for a < b
///     G(a, b) = transfer[a] transfer[a+1] ... transfer[b-1] own[b].
struct CondensedChain {
  std::vector<Index> node;     ///< ascending; rows on other nodes answer nothing
  std::vector<Mat6> own;       ///< G(a, a), symmetric
  std::vector<Mat6> transfer;  ///< to the next node; that of the last one is zero
};

/// Adds the compliance of rows to a matrix. Keeps its memory from step to step.
class ChainCompliance {
 public:
  /// W(row, row') += h^2 H A^-1 H^T over the rows, A^-1 between the nodes that may move.
  void add(const BlockTridiagonal& A, const std::vector<Index>& clamped, const BodyRows& rows,
           Real dt, Eigen::Ref<MatX> W);
  /// W(row, row') += H G H^T, G what `chain` says.
  void add(const CondensedChain& chain, const BodyRows& rows, Eigen::Ref<MatX> W);

 private:
  // A row per force: what is done to all of them is a vector operation.
  using Panel = Eigen::Matrix<Real, 4, 6>;
  struct Entry {
    std::size_t place;  // of its node in the chain
    Vec6 value;
  };

  void read(const CondensedChain& chain, const BodyRows& rows);

  CondensedChain chain_;
  std::vector<Entry> entry_;              // of all rows, ascending along the chain in each
  std::vector<std::size_t> first_entry_;  // per row, and the end
  std::vector<Panel> panel_;
  GrowingMat own_W_;
};

}  // namespace sutura::thread
