// Scalars, small vectors and poses used by every part of Sutura. SI units throughout.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sutura {

using Real = double;
using Index = Eigen::Index;

using Vec2 = Eigen::Matrix<Real, 2, 1>;
using Vec3 = Eigen::Matrix<Real, 3, 1>;
using Vec6 = Eigen::Matrix<Real, 6, 1>;
using Mat3 = Eigen::Matrix<Real, 3, 3>;
using Mat6 = Eigen::Matrix<Real, 6, 6>;
using VecX = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using MatX = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Quat = Eigen::Quaternion<Real>;

/// A rigid placement: x = position + rotation * x_local.
struct Pose {
  Vec3 position = Vec3::Zero();      ///< m
  Quat rotation = Quat::Identity();  ///< unit quaternion
};

/// A force and a moment about the point it acts on.
struct Wrench {
  Vec3 force = Vec3::Zero();   ///< N
  Vec3 moment = Vec3::Zero();  ///< N m
};

/// The matrix of v -> a x v.
inline Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

/// The shortest rotation that takes the direction of `from` to that of `to`; where they are
/// opposite, half a turn about some axis across.
Quat shortest_rotation(const Vec3& from, const Vec3& to);

}  // namespace sutura
