#include "rotation.h"

#include <Eigen/SVD>
#include <algorithm>

namespace sutura::tissue {

Mat3 rotation_by_svd(const Mat3& F) {
  if (!F.allFinite()) return Mat3::Identity();
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) = -U.col(2);
  return U * svd.matrixV().transpose();
}

Mat3 nearest_rotation(const Mat3& F) {
  Small3<Real> f, r;
  std::copy_n(F.data(), 9, f.begin());
  if (rotation_closed_form(f, r)) return rotation_by_svd(F);
  return Eigen::Map<const Mat3>(r.data());
}

}  // namespace sutura::tissue
