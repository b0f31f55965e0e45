#include "rotation.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

namespace sutura::tissue {
namespace {

Mat3 random_matrix(std::mt19937& random) {
  std::normal_distribution<Real> normal;
  Mat3 M;
  for (int i = 0; i < 9; ++i) M.data()[i] = normal(random);
  return M;
}
Mat3 random_rotation(std::mt19937& random) {
  std::normal_distribution<Real> normal;
  return Quat(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}
/// Rotation test that shares nothing with the code: R is a rotation, R^T F is symmetric, and its
/// two smallest eigenvalues do not sum to less than zero (so that R maximises tr R^T F).
void expect_nearest(const Mat3& F, const Mat3& R, Real tolerance) {
  EXPECT_LT((R.transpose() * R - Mat3::Identity()).norm(), tolerance);
  EXPECT_GT(R.determinant(), 0);
  const Mat3 S = R.transpose() * F;
  EXPECT_LT((S - S.transpose()).norm(), tolerance * F.norm());
  const Vec3 s = Eigen::SelfAdjointEigenSolver<Mat3>(0.5 * (S + S.transpose())).eigenvalues();
  EXPECT_GT(s[0] + s[1], -tolerance * F.norm());
}

// The promise of the closed form: wherever it does not hand over to the SVD, R is good to 1e-10
// (rounding times the square of |F|^3 / slope <= 1e4, and some).
TEST(Rotation, RandomMatricesAlsoInverted) {
  std::mt19937 random(1);
  int refused = 0;
  for (int i = 0; i < 20000; ++i) {
    const Mat3 F = random_matrix(random);
    Small3<Real> f, r;
    std::copy_n(F.data(), 9, f.begin());
    if (rotation_closed_form(f, r)) ++refused;
    const Mat3 R = nearest_rotation(F);
    expect_nearest(F, R, 1e-10);
    if (::testing::Test::HasFailure()) FAIL() << "F =\n" << F;
  }
  EXPECT_LT(refused, 2000);  // the slow path is for the rare
}

TEST(Rotation, StretchedMatricesNearRest) {
  std::mt19937 random(2);
  for (int i = 0; i < 2000; ++i) {
    const Mat3 R0 = random_rotation(random), Q = random_rotation(random);
    const Vec3 s = Vec3::Ones() + 0.3 * Vec3::Random();
    const Mat3 F = R0 * Q * s.asDiagonal() * Q.transpose();
    EXPECT_LT((nearest_rotation(F) - R0).norm(), 1e-13);  // a few roundings
  }
}

TEST(Rotation, LanesAgreeWithOneAtATime) {
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    Small3<Lanes> F, R;
    std::array<Mat3, lanes> each;
    for (int k = 0; k < lanes; ++k) {
      each[k] = random_matrix(random);
      for (int c = 0; c < 9; ++c) F[c][k] = each[k].data()[c];
    }
    const LaneMask refused = rotation_closed_form(F, R);
    for (int k = 0; k < lanes; ++k) {
      if (refused[k]) continue;
      Mat3 r;
      for (int c = 0; c < 9; ++c) r.data()[c] = R[c][k];
      expect_nearest(each[k], r, 1e-10);
    }
  }
}

TEST(Rotation, DegenerateMatricesGiveSomeRotation) {
  const Vec3 d(1, 2, 3), e(0, 1, -1);
  for (const Mat3& F : {Mat3(Mat3::Zero()), Mat3(d * e.transpose()), Mat3(-Mat3::Identity()),
                        Mat3(Vec3(1, 1, 0).asDiagonal()), Mat3(Vec3(1, 0.5, -0.5).asDiagonal()),
                        Mat3(1e-30 * Mat3::Identity()), Mat3(1e30 * Mat3::Identity()),
                        Mat3(Vec3(1, 1e-9, -1e-9).asDiagonal())}) {
    const Mat3 R = nearest_rotation(F);
    EXPECT_LT((R.transpose() * R - Mat3::Identity()).norm(), 1e-10) << F;
    EXPECT_NEAR(R.determinant(), 1, 1e-10) << F;
  }
  Mat3 bad = Mat3::Identity();
  bad(1, 1) = std::numeric_limits<Real>::quiet_NaN();
  EXPECT_EQ(nearest_rotation(bad), Mat3(Mat3::Identity()));
}

// A mirrored tet: naive polar would give a reflection; ours stays a rotation and the strain shows
// it.
TEST(Rotation, MirroredMatrixKeepsTheSmallestStretchNegative) {
  const Mat3 F = Vec3(1.0, 0.9, -0.3).asDiagonal();
  EXPECT_LT((nearest_rotation(F) - Mat3::Identity()).norm(), 1e-12);
}

}  // namespace
}  // namespace sutura::tissue
