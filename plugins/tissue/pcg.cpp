#include "pcg.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace sutura::tissue {

void clear_fixed(std::span<const char> fixed, Eigen::Ref<MatX> columns) {
  for (std::size_t i = 0; i < fixed.size(); ++i)
    if (fixed[i]) columns.middleRows<3>(3 * static_cast<Index>(i)).setZero();
}

void BlockJacobi::compute(const NodeMatrix& A, std::span<const char> fixed) {
  inverse_.assign(static_cast<std::size_t>(A.nodes()), Mat3::Zero());
  for (std::size_t i = 0; i < inverse_.size(); ++i) {
    if (!fixed.empty() && fixed[i]) continue;
    const Mat3 block = A.block(static_cast<Index>(i), static_cast<Index>(i));
    bool invertible = false;
    Mat3 inverse;
    block.computeInverseWithCheck(inverse, invertible);
    inverse_[i] = invertible ? inverse : Mat3::Identity();
  }
}

void BlockJacobi::apply(Eigen::Ref<MatX> columns) const {
  for (Index c = 0; c < columns.cols(); ++c)
    for (std::size_t i = 0; i < inverse_.size(); ++i) {
      auto v = columns.col(c).segment<3>(3 * static_cast<Index>(i));
      v = (inverse_[i] * v).eval();
    }
}

void WarpedFactor::set(const Factor& factor, std::span<const Mat3> then, std::span<const Mat3> now,
                       bool rough) {
  assert(then.size() == now.size());
  factor_ = &factor;
  rough_ = rough;
  then_ = then;
  now_ = now;
  turn_.resize(now.size());
  turns_are_known_ = false;
}

std::span<const Mat3> WarpedFactor::turns() const {
  if (turns_are_known_) return turn_;
  turns_are_known_ = true;
  for (std::size_t i = 0; i < now_.size(); ++i) turn_[i] = now_[i] * then_[i].transpose();
  return turn_;
}

void WarpedFactor::apply(Eigen::Ref<MatX> columns) const {
  turns();
  for (Index c = 0; c < columns.cols(); ++c)
    for (std::size_t i = 0; i < turn_.size(); ++i) {
      auto v = columns.col(c).segment<3>(3 * static_cast<Index>(i));
      v = (turn_[i].transpose() * v).eval();
    }
  if (rough_)
    factor_->solve_roughly(columns);
  else
    factor_->solve(columns);
  for (Index c = 0; c < columns.cols(); ++c)
    for (std::size_t i = 0; i < turn_.size(); ++i) {
      auto v = columns.col(c).segment<3>(3 * static_cast<Index>(i));
      v = (turn_[i] * v).eval();
    }
}

void Pcg::reserve(Index n) {
  for (GrowingMat* m : {&r_, &z_, &p_}) m->resize(n, 1);
  for (GrowingVec* v : {&rz_, &norm_b_}) v->resize(1);
  for (VecX* v : {&in_, &out_}) v->resize(n);
  column_.reserve(1);
}

/// Column c is finished: the last active one takes its place.
void Pcg::drop(Index c, Index& active) {
  --active;
  if (c == active) return;
  r_.col(c) = r_.col(active);
  z_.col(c) = z_.col(active);
  p_.col(c) = p_.col(active);
  rz_[c] = rz_[active];
  norm_b_[c] = norm_b_[active];
  column_[static_cast<std::size_t>(c)] = column_[static_cast<std::size_t>(active)];
}

PcgReport Pcg::solve(const NodeMatrix& A, std::span<const char> fixed, const Preconditioner& P,
                     const Eigen::Ref<const MatX>& b, GrowingMat& x, Real tolerance,
                     Index max_iterations, bool start_from_x) {
  const Index n = b.rows();
  Index active = b.cols();
  for (GrowingMat* m : {&r_, &z_, &p_}) m->resize(n, active);
  rz_.resize(active);
  norm_b_.resize(active);
  in_.resize(n);
  column_.resize(static_cast<std::size_t>(active));

  r_.leftCols(active) = b;
  clear_fixed(fixed, r_.leftCols(active));
  for (Index c = 0; c < active; ++c) {
    norm_b_[c] = r_.col(c).norm();
    column_[static_cast<std::size_t>(c)] = c;
  }
  if (start_from_x) {
    clear_fixed(fixed, x);
    for (Index c = 0; c < active; ++c) {
      in_ = x.col(c);
      A.multiply(in_, out_);
      r_.col(c) -= out_;
    }
    clear_fixed(fixed, r_.leftCols(active));
  } else {
    x.setZero(n, active);
  }

  PcgReport report;
  const auto retire = [&](Index c, Real residual, bool converged) {
    report.residual = std::max(report.residual, residual);
    report.converged = report.converged && converged;
    drop(c, active);
  };
  for (Index c = active - 1; c >= 0; --c) {
    const Real residual = norm_b_[c] > 0 ? r_.col(c).norm() / norm_b_[c] : 0;
    if (!std::isfinite(norm_b_[c]) || !std::isfinite(residual))
      retire(c, residual, false);
    else if (residual <= tolerance)
      retire(c, residual, true);
  }

  while (active > 0) {
    z_.leftCols(active) = r_.leftCols(active);
    P.apply(z_.leftCols(active));
    const bool first = report.iterations == 0;
    for (Index c = 0; c < active; ++c) {
      const Real rz = r_.col(c).dot(z_.col(c));
      if (first)
        p_.col(c) = z_.col(c);
      else
        p_.col(c) = z_.col(c) + (rz / rz_[c]) * p_.col(c);
      rz_[c] = rz;
    }
    ++report.iterations;
    for (Index c = active - 1; c >= 0; --c) {
      in_ = p_.col(c);
      A.multiply(in_, out_);
      clear_fixed(fixed, out_);
      const Real pAp = in_.dot(out_);
      const Real alpha = rz_[c] / pAp;
      if (!(pAp > 0) || !(alpha > 0) || !std::isfinite(alpha)) {
        retire(c, r_.col(c).norm() / norm_b_[c], false);
        continue;
      }
      x.col(column_[static_cast<std::size_t>(c)]) += alpha * in_;
      r_.col(c) -= alpha * out_;
      const Real residual = r_.col(c).norm() / norm_b_[c];
      if (residual <= tolerance)
        retire(c, residual, true);
      else if (report.iterations >= max_iterations || !std::isfinite(residual))
        retire(c, residual, false);
    }
  }
  return report;
}

}  // namespace sutura::tissue
