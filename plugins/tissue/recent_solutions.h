// Where conjugate gradients start: the best combination, in the energy norm, of the solutions of
// the last steps. Forces and matrix change smoothly, so what was just solved is most of what is
// asked next; it costs one product with A per solution, where an iteration costs two triangular
// solves.
#pragma once

#include <array>

#include "block_matrix.h"
#include "sutura/device.h"
#include "sutura/growing.h"

namespace sutura::tissue {

class RecentSolutions {
 public:
  static constexpr Index most = ConjugateGradientDevice::most_recent;
  /// Forgets them all; those to come have size n.
  void reset(Index n);
  /// The products with A have to be made anew.
  void matrix_changed() { product_is_known_.fill(false); }
  /// x <- sum c_k x_k with the least |x - A^-1 b|_A. False, x untouched, if there is nothing yet.
  bool start(const NodeMatrix& A, std::span<const char> fixed, const VecX& b, GrowingMat& x);
  /// Keeps a solution in place of the oldest one, unless it is zero or not finite.
  void add(const VecX& x);
  /// Those that are kept, by columns, and which of them the next one replaces.
  auto all() const { return x_.leftCols(count_); }
  Index next() const { return next_; }
  void archive(Archive& archive);

 private:
  void multiply(const NodeMatrix& A, std::span<const char> fixed, Index column);
  MatX x_, Ax_;
  VecX in_, out_;
  Index count_ = 0, next_ = 0;
  std::array<bool, most> product_is_known_{};  ///< per column, that of Ax_
};

}  // namespace sutura::tissue
