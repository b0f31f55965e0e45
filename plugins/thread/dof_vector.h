// A vector over the dofs of a rod whose storage only grows: to shrink and to grow within the
// reserve allocates nothing, which Eigen's own vectors do at every change of size.
#pragma once

#include <new>
#include <utility>
#include <vector>

#include "sutura/archive.h"

namespace sutura::thread {

class DofVector : public Eigen::Map<VecX> {
  using Base = Eigen::Map<VecX>;

 public:
  DofVector() : Base(nullptr, 0) {}
  DofVector(const DofVector& other) : Base(nullptr, 0), store_(other.store_) { seat(); }
  DofVector(DofVector&& other) noexcept : Base(nullptr, 0), store_(std::move(other.store_)) {
    seat();
    other.store_.clear();
    other.seat();
  }
  DofVector& operator=(const DofVector& other) {
    store_ = other.store_;
    seat();
    return *this;
  }
  DofVector& operator=(DofVector&& other) noexcept {
    store_.swap(other.store_);
    seat();
    other.seat();
    return *this;
  }
  /// Coefficients of an expression of the same size.
  template <class Derived>
  DofVector& operator=(const Eigen::MatrixBase<Derived>& x) {
    Base::operator=(x);
    return *this;
  }

  void archive(Archive& a, std::string_view name) {
    a(name, store_);
    seat();
  }
  void reserve(Index size) {
    store_.reserve(static_cast<std::size_t>(size));
    seat();
  }
  /// Resizes and fills with zeros.
  void clear(Index size) {
    store_.assign(static_cast<std::size_t>(size), 0);
    seat();
  }

 private:
  void seat() {
    new (static_cast<Base*>(this)) Base(store_.data(), static_cast<Index>(store_.size()));
  }
  std::vector<Real> store_;
};

/// What functions take that read one: no copy from DofVector, VecX or a block of either.
using Dofs = Eigen::Ref<const VecX>;

}  // namespace sutura::thread
