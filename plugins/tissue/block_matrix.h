// The system matrix of a tissue: symmetric, one 3x3 block per pair of coupled nodes, fixed pattern.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sutura/device.h"
#include "sutura/types.h"

namespace sutura {
class Archive;
}

namespace sutura::tissue {

/// Which blocks exist. Only i <= j is stored: by rows, columns ascending, so the diagonal block is
/// the first of its row. Immutable, shared between a matrix, its copies and its factors.
class NodePattern {
 public:
  /// `pairs`: the coupled nodes i != j, in any order, repeated at will. Every diagonal block
  /// exists.
  NodePattern(Index nodes, std::span<const std::array<Index, 2>> pairs);

  Index nodes() const { return static_cast<Index>(row_start_.size()) - 1; }
  Index slots() const { return static_cast<Index>(column_.size()); }
  /// Where block (i, j), i <= j, is stored; -1 if it is not.
  Index slot(Index i, Index j) const;
  Index diagonal(Index i) const { return row_start_[static_cast<std::size_t>(i)]; }
  std::span<const std::int32_t> row_start() const { return row_start_; }
  std::span<const std::int32_t> column() const { return column_; }

 private:
  std::vector<std::int32_t> row_start_;  ///< nodes + 1
  std::vector<std::int32_t> column_;     ///< per slot
};

/// The coupled pairs of elements of `size` nodes each, i < j, sorted, each once.
std::vector<std::array<Index, 2>> pairs_of_elements(std::span<const Index> element_nodes,
                                                    Index size);

class NodeMatrix;

/// Who has made the numbers of a matrix on a device.
class MatrixSource {
 public:
  virtual ~MatrixSource() = default;
  /// Brings them here, or makes them again.
  virtual void bring(NodeMatrix& A) = 0;
};

/// Not called BlockMatrix: that is the matrix of one constraint block (sutura/law.h).
class NodeMatrix {
 public:
  explicit NodeMatrix(std::shared_ptr<const NodePattern> pattern);
  /// A copy has its own numbers, here.
  NodeMatrix(const NodeMatrix& other);
  NodeMatrix& operator=(const NodeMatrix& other);
  NodeMatrix(Index nodes, std::span<const std::array<Index, 2>> pairs)
      : NodeMatrix(std::make_shared<NodePattern>(nodes, pairs)) {}

  const std::shared_ptr<const NodePattern>& pattern() const { return pattern_; }
  Index nodes() const { return pattern_->nodes(); }
  Index slot(Index i, Index j) const { return pattern_->slot(i, j); }

  /// Nine numbers per slot, the rows of block (i, j), i <= j; the block (j, i) is its transpose.
  Real* values() {
    bring();
    is_there_ = false;
    return values_.data();
  }
  const Real* values() const {
    bring();
    return values_.data();
  }
  /// The numbers are on a device; `source` brings them when somebody reads them.
  void leave_there(MatrixSource& source);
  bool is_there() const { return is_there_; }
  /// Where the source puts them.
  std::span<Real> room() { return {values_.data(), values_.size() - 1}; }
  void set_zero();
  /// A += scale * m I on the diagonal block of every node; `m` per node.
  void add_diagonal(std::span<const Real> m, Real scale);
  void archive(Archive& archive);
  Mat3 block(Index i, Index j) const;  ///< any order; zero if not in the pattern

  /// y = A x, both 3 n. Deterministic: fixed order of sums.
  void multiply(const VecX& x, VecX& y) const;

 private:
  void bring() const;

  std::shared_ptr<const NodePattern> pattern_;
  std::vector<Real> values_;  ///< 9 per slot, and one more: rows are read four numbers at a time
  MatrixSource* source_ = nullptr;
  bool is_there_ = false;
  mutable bool is_here_ = true;
};

/// For a device.
inline NodeMatrixView view_of(const NodeMatrix& A) {
  const NodePattern& p = *A.pattern();
  return {p.nodes(), p.row_start(), p.column(), A.values()};
}

}  // namespace sutura::tissue
