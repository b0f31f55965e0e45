// The inverse of L L^T, with the memory that it takes kept from one to the next.
#pragma once

#include <optional>

#include "sutura/types.h"

namespace sutura::tissue {

class DenseInverse {
 public:
  /// inverse <- (L L^T)^-1 of a dense lower triangle.
  void compute(const MatX& lower, MatX& inverse);

 private:
  // Eigen's triangular solve and rank update take their work space from the heap in every call,
  // unless it is handed to them.
  template <int step>
  using WorkSpace =
      Eigen::internal::gemm_blocking_space<Eigen::ColMajor, Real, Real, Eigen::Dynamic,
                                           Eigen::Dynamic, Eigen::Dynamic, step>;
  std::optional<WorkSpace<4>> solve_;
  std::optional<WorkSpace<1>> update_;
  MatX inverse_of_lower_;
};

}  // namespace sutura::tissue
