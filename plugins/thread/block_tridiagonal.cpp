#include "block_tridiagonal.h"

#include <Eigen/Eigenvalues>
#include <cassert>
#include <cmath>

namespace sutura::thread {

namespace {

/// Inverse of a symmetric 3 x 3 that is positive definite; false if it is not. By L D L^T:
/// cofactors would lose twice the digits where a beam is a million times stiffer along than across.
inline bool invert_definite(const Mat3& a, Mat3& inv) {
  const Real d0 = a(0, 0), l10 = a(1, 0) / d0, l20 = a(2, 0) / d0;
  const Real d1 = a(1, 1) - l10 * a(1, 0), e = a(2, 1) - l10 * a(2, 0), l21 = e / d1;
  const Real d2 = a(2, 2) - l20 * a(2, 0) - l21 * e;
  if (!(d0 > 0 && d1 > 0 && d2 > 0)) return false;
  const Real m20 = l10 * l21 - l20;  // of L^-1
  const Real i1 = 1 / d1, i2 = 1 / d2;
  inv(0, 0) = 1 / d0 + l10 * l10 * i1 + m20 * m20 * i2;
  inv(0, 1) = inv(1, 0) = -l10 * i1 - m20 * l21 * i2;
  inv(0, 2) = inv(2, 0) = m20 * i2;
  inv(1, 1) = i1 + l21 * l21 * i2;
  inv(1, 2) = inv(2, 1) = -l21 * i2;
  inv(2, 2) = i2;
  return true;
}

/// Inverse of a symmetric 3 x 3 by cofactors; false unless it is regular.
inline bool invert_regular(const Mat3& a, Mat3& inv) {
  const Real c00 = a(1, 1) * a(2, 2) - a(1, 2) * a(1, 2);
  const Real c01 = a(0, 2) * a(1, 2) - a(0, 1) * a(2, 2);
  const Real c02 = a(0, 1) * a(1, 2) - a(0, 2) * a(1, 1);
  const Real c22 = a(0, 0) * a(1, 1) - a(0, 1) * a(0, 1);
  const Real det = a(0, 0) * c00 + a(0, 1) * c01 + a(0, 2) * c02;
  if (!std::isnormal(det)) return false;
  const Real f = 1 / det;
  inv(0, 0) = c00 * f;
  inv(0, 1) = inv(1, 0) = c01 * f;
  inv(0, 2) = inv(2, 0) = c02 * f;
  inv(1, 1) = (a(0, 0) * a(2, 2) - a(0, 2) * a(0, 2)) * f;
  inv(1, 2) = inv(2, 1) = (a(0, 1) * a(0, 2) - a(0, 0) * a(1, 2)) * f;
  inv(2, 2) = c22 * f;
  return true;
}

/// By L D L^T where it is definite.
inline bool invert3(const Mat3& a, Mat3& inv, bool indefinite) {
  return invert_definite(a, inv) || (indefinite && invert_regular(a, inv));
}

/// Inverse of a symmetric 6 x 6 through its 3 x 3 blocks.
inline bool invert6(const Mat6& s, Mat6& inv, bool indefinite) {
  const Mat3 a = s.topLeftCorner<3, 3>(), b = s.topRightCorner<3, 3>();
  Mat3 ai, ci;
  if (!invert3(a, ai, indefinite)) return false;
  const Mat3 w = ai * b;
  const Mat3 c = s.bottomRightCorner<3, 3>() - b.transpose() * w;
  if (!invert3(c, ci, indefinite)) return false;
  const Mat3 wc = w * ci;
  inv.topLeftCorner<3, 3>() = ai + wc * w.transpose();
  inv.topRightCorner<3, 3>() = -wc;
  inv.bottomLeftCorner<3, 3>() = -wc.transpose();
  inv.bottomRightCorner<3, 3>() = ci;
  return true;
}

}  // namespace

void BlockTridiagonal::resize(Index blocks) {
  const auto n = static_cast<std::size_t>(blocks);
  for (auto* v : {&diagonal_, &upper_, &inverse_, &transfer_}) v->resize(n, Mat6::Zero());
}

void BlockTridiagonal::reserve(Index blocks) {
  for (auto* v : {&diagonal_, &upper_, &inverse_, &transfer_})
    v->reserve(static_cast<std::size_t>(blocks));
}

void BlockTridiagonal::set_zero() {
  for (Mat6& m : diagonal_) m.setZero();
  for (Mat6& m : upper_) m.setZero();
}

void BlockTridiagonal::fix(Index i, Index dof) {
  diagonal_[i].row(dof).setZero();
  diagonal_[i].col(dof).setZero();
  diagonal_[i](dof, dof) = 1;
  if (i + 1 < blocks()) upper_[i].row(dof).setZero();
  if (i > 0) upper_[i - 1].col(dof).setZero();
}

bool BlockTridiagonal::factor(bool indefinite) {
  const Index n = blocks();
  pivot_ = diagonal_[0];
  for (Index i = 0;; ++i) {
    pivot_block_ = i;
    if (!invert6(pivot_, inverse_[i], indefinite)) return false;
    if (i + 1 == n) return true;
    transfer_[i].noalias() = inverse_[i] * upper_[i];
    pivot_ = diagonal_[i + 1];
    pivot_.noalias() -= upper_[i].transpose() * transfer_[i];
  }
}

/// With x_k = v at the block that failed, x_i = -T_i x_{i+1} before and 0 after it, x^T A x = v^T
/// S_k v.
void BlockTridiagonal::negative_direction(Real scale, Eigen::Ref<VecX> x) const {
  Vec6 units = Vec6::Ones();
  units.tail<3>() /= scale;
  const Mat6 pivot = units.asDiagonal() * pivot_ * units.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Mat6> modes(pivot);
  x.setZero();
  Vec6 next = units.asDiagonal() * modes.eigenvectors().col(0);
  x.segment<6>(6 * pivot_block_) = next;
  for (Index i = pivot_block_; i-- > 0;) {
    next = -(transfer_[i] * next).eval();
    x.segment<6>(6 * i) = next;
  }
}

void BlockTridiagonal::solve(Eigen::Ref<VecX> x) const {
  const Index n = blocks();
  assert(x.size() == 6 * n);
  for (Index i = 0; i + 1 < n; ++i)
    x.segment<6>(6 * (i + 1)).noalias() -= transfer_[i].transpose() * x.segment<6>(6 * i);
  Vec6 next = inverse_[n - 1] * x.segment<6>(6 * (n - 1));
  x.segment<6>(6 * (n - 1)) = next;
  for (Index i = n - 1; i-- > 0;) {
    Vec6 z = x.segment<6>(6 * i);
    Vec6 u = inverse_[i] * z;
    u.noalias() -= transfer_[i] * next;
    x.segment<6>(6 * i) = u;
    next = u;
  }
}

void BlockTridiagonal::solve(Eigen::Ref<MatX> columns) const {
  const Index n = blocks();
  assert(columns.rows() == 6 * n);
  constexpr int width = 8;
  using Slab = Eigen::Matrix<Real, 6, width>;
  Index j = 0;
  for (; j + width <= columns.cols(); j += width) {
    for (Index i = 0; i + 1 < n; ++i) {
      const Slab z = columns.block<6, width>(6 * i, j);
      columns.block<6, width>(6 * (i + 1), j).noalias() -= transfer_[i].transpose() * z;
    }
    Slab next = Slab::Zero();
    for (Index i = n; i-- > 0;) {
      const Slab z = columns.block<6, width>(6 * i, j);
      Slab u;
      u.noalias() = inverse_[i] * z;
      if (i + 1 < n) u.noalias() -= transfer_[i] * next;
      columns.block<6, width>(6 * i, j) = u;
      next = u;
    }
  }
  for (; j < columns.cols(); ++j) solve(Eigen::Ref<VecX>(columns.col(j)));
}

void BlockTridiagonal::multiply(const Eigen::Ref<const VecX>& x, Eigen::Ref<VecX> y) const {
  const Index n = blocks();
  assert(x.size() == 6 * n && y.size() == 6 * n);
  for (Index i = 0; i < n; ++i) {
    Vec6 sum = diagonal_[i] * x.segment<6>(6 * i);
    if (i + 1 < n) sum += upper_[i] * x.segment<6>(6 * (i + 1));
    if (i > 0) sum += upper_[i - 1].transpose() * x.segment<6>(6 * (i - 1));
    y.segment<6>(6 * i) = sum;
  }
}

void BlockTridiagonal::condense(const std::vector<Index>& nodes, std::vector<Mat6>& own,
                                std::vector<Mat6>& transfer) const {
  const std::size_t k = nodes.size();
  own.resize(k);
  transfer.resize(k);
  if (k == 0) return;
  // Diagonal blocks by the backward recursion, from the far end; transfers multiplied up between
  // touched nodes.
  Mat6 g = inverse_[blocks() - 1], product;
  std::size_t t = k;
  if (nodes[t - 1] == blocks() - 1) own[--t] = g;
  for (Index i = blocks() - 1; i-- > 0 && t > 0;) {
    product.noalias() = transfer_[i] * g;
    g = inverse_[i];
    g.noalias() += product * transfer_[i].transpose();
    if (nodes[t - 1] == i) own[--t] = g;
  }
  transfer[k - 1].setZero();
  for (std::size_t a = 0; a + 1 < k; ++a) {
    transfer[a] = -transfer_[nodes[a]];
    for (Index i = nodes[a] + 1; i < nodes[a + 1]; ++i) {
      product.noalias() = transfer[a] * transfer_[i];
      transfer[a] = -product;
    }
  }
}

}  // namespace sutura::thread
