// Vectors and matrices that keep their memory when they shrink, as std::vector does: what changes
// its size from step to step allocates nothing once the largest size has been seen.
#pragma once

#include <algorithm>
#include <cstddef>
#include <new>
#include <vector>

#include "sutura/types.h"

namespace sutura {

/// To be used like Plain (VecX or MatX). A change of size leaves the entries unspecified.
template <class Plain>
class Growing : public Eigen::Map<Plain, Eigen::AlignedMax> {
 public:
  using Base = Eigen::Map<Plain, Eigen::AlignedMax>;

  Growing() : Base(nullptr, 0, Plain::ColsAtCompileTime == 1 ? 1 : 0) {}
  Growing(const Growing& other) : Growing() { *this = other; }
  template <class D>
  explicit Growing(const Eigen::DenseBase<D>& other) : Growing() {
    *this = other;
  }
  Growing& operator=(const Growing& other) { return assign(other); }
  template <class D>
  Growing& operator=(const Eigen::DenseBase<D>& other) {
    return assign(other.derived());
  }

  void resize(Index rows, Index cols = 1) {
    const auto needed = static_cast<std::size_t>(rows * cols);
    if (needed > memory_.size()) memory_.resize(std::max(needed, 2 * memory_.size()));
    new (static_cast<Base*>(this)) Base(memory_.data(), rows, cols);
  }
  using Base::setZero;
  void setZero(Index rows, Index cols = 1) {
    resize(rows, cols);
    Base::setZero();
  }

 private:
  template <class Other>
  Growing& assign(const Other& other) {
    resize(other.rows(), other.cols());
    Base::operator=(other);
    return *this;
  }

  std::vector<Real, Eigen::aligned_allocator<Real>> memory_;
};

using GrowingVec = Growing<VecX>;
using GrowingMat = Growing<MatX>;

}  // namespace sutura
