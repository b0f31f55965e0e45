#include "recent_solutions.h"

#include <Eigen/Cholesky>
#include <cassert>

#include "pcg.h"

namespace sutura::tissue {

void RecentSolutions::reset(Index n) {
  for (MatX* m : {&x_, &Ax_}) m->resize(n, most);
  for (VecX* v : {&in_, &out_}) v->resize(n);
  count_ = next_ = 0;
  matrix_changed();
}

void RecentSolutions::multiply(const NodeMatrix& A, std::span<const char> fixed, Index column) {
  in_ = x_.col(column);
  A.multiply(in_, out_);
  clear_fixed(fixed, out_);
  Ax_.col(column) = out_;
}

bool RecentSolutions::start(const NodeMatrix& A, std::span<const char> fixed, const VecX& b,
                            GrowingMat& x) {
  if (count_ == 0) return false;
  for (Index i = 0; i < count_; ++i) {
    bool& known = product_is_known_[static_cast<std::size_t>(i)];
    if (!known) multiply(A, fixed, i);
    known = true;
  }
  // At most six by six: no memory from the heap.
  using Small = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
  using Weights = Eigen::Matrix<Real, Eigen::Dynamic, 1, 0, most, 1>;
  Small G(count_, count_);
  for (Index i = 0; i < count_; ++i)
    for (Index j = 0; j < count_; ++j) G(i, j) = x_.col(i).dot(Ax_.col(j));
  const Weights scale = G.diagonal().cwiseMax(0).cwiseSqrt();
  if (!(scale.minCoeff() > 0) || !scale.allFinite()) return false;
  // Scaled to ones on the diagonal; solutions of successive steps are nearly parallel, and
  // directions that differ by rounding only are left out by the small shift.
  Small S = G;
  for (Index i = 0; i < count_; ++i)
    for (Index j = 0; j < count_; ++j) S(i, j) = (G(i, j) + G(j, i)) / (2 * scale[i] * scale[j]);
  S.diagonal().array() += 1e-10;
  Weights c = x_.leftCols(count_).transpose() * b;
  c = c.cwiseQuotient(scale);
  c = S.ldlt().solve(c).eval();
  c = c.cwiseQuotient(scale);
  if (!c.allFinite()) return false;
  x.setZero(x_.rows(), 1);
  for (Index i = 0; i < count_; ++i) x.col(0) += c[i] * x_.col(i);
  return true;
}

void RecentSolutions::add(const VecX& x) {
  assert(x.size() == x_.rows());
  if (!x.allFinite() || x.isZero(0)) return;
  x_.col(next_) = x;
  product_is_known_[static_cast<std::size_t>(next_)] = false;
  next_ = (next_ + 1) % most;
  count_ = std::min(count_ + 1, most);
}

}  // namespace sutura::tissue
