#include "dense_inverse.h"

namespace sutura::tissue {

void DenseInverse::compute(const MatX& lower, MatX& inverse) {
  const Index n = lower.rows();
  MatX& M = inverse_of_lower_;
  inverse.setZero(n, n);
  if (n == 0) return;
  if (M.rows() != n) {
    solve_.emplace(n, n, n, 1, false);
    solve_->allocateAll();
    update_.emplace(n, n, n, 1, false);
    update_->allocateAll();
  }
  // M = lower^-1
  M.setIdentity(n, n);
  Eigen::internal::triangular_solve_matrix<Real, Index, Eigen::OnTheLeft, Eigen::Lower, false,
                                           Eigen::ColMajor, Eigen::ColMajor, 1>::run(n, n,
                                                                                     lower.data(),
                                                                                     n, M.data(), 1,
                                                                                     n, *solve_);
  // inverse = M^T M
  Eigen::internal::general_matrix_matrix_triangular_product<
      Index, Real, Eigen::RowMajor, false, Real, Eigen::ColMajor, false, Eigen::ColMajor, 1,
      Eigen::Lower>::run(n, n, M.data(), n, M.data(), n, inverse.data(), 1, n, 1.0, *update_);
  inverse.triangularView<Eigen::StrictlyUpper>() = inverse.transpose();
}

}  // namespace sutura::tissue
