// The stiffness against twist: against its formula and the eigenvalues of it, four at a time.
#include "twist_stiffness.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <random>

namespace sutura::tissue {
namespace {

/// From the formula of the header, with negative eigenvalues raised.
Mat3 expected(const Mat3& strain, Real mu, Real lambda) {
  const Real trace = strain.trace();
  const Mat3 N = (2 + trace) * Mat3::Identity() - strain;
  const Mat3 G = 2 * mu * Mat3::Identity() + 2 * (lambda * trace - 2 * mu) * N.inverse();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(0.5 * (G + G.transpose()));
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

void compare(const Mat3 (&strain)[lanes], Real mu, Real lambda) {
  Lanes E[6], G[6], m = Lanes{} + mu, l = Lanes{} + lambda;
  constexpr int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < lanes; ++k) E[i][k] = strain[k](row[i], column[i]);
  twist_stiffness(E, m, l, G);
  for (int k = 0; k < lanes; ++k) {
    const Mat3 right = expected(strain[k], mu, lambda);
    // Eigenvalues below 1e-9 of the moduli may be kept or raised; the rest is rounding.
    for (int i = 0; i < 6; ++i)
      EXPECT_NEAR(G[i][k], right(row[i], column[i]), 4e-9 * (mu + std::abs(lambda)))
          << "strain\n"
          << strain[k] << "\nmu " << mu << " lambda " << lambda;
  }
}

TEST(TwistStiffness, PositivePartOfRandomStrains) {
  std::mt19937 random(7);
  std::uniform_real_distribution<Real> uniform(-1, 1);
  for (int n = 0; n < 5000; ++n) {
    const Real size = 0.5 * std::pow(10, -4 * std::abs(uniform(random)));
    Mat3 strain[lanes];
    for (Mat3& s : strain) {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j) s(i, j) = s(j, i) = size * uniform(random) / 3;
    }
    compare(strain, 1 + uniform(random) * 0.9, 20 * std::abs(uniform(random)) - 0.05);
  }
}

TEST(TwistStiffness, EqualAndVanishingEigenvalues) {
  const Vec3 diagonals[] = {{0, 0, 0},          {-0.1, -0.1, -0.1}, {-0.1, 0, 0},
                            {-0.1, -0.1, 0},    {0.1, -0.1, 0},     {0.2, -0.1, -0.1},
                            {1e-14, -1e-14, 0}, {-1e-7, 1e-7, 0},   {0.3, -0.29, 0.02},
                            {-0.2, -0.2, 0.4},  {0.1, 0.1, -0.2},   {-0.4, 0.1, 0.1}};
  const Mat3 turn = Quat(0.3, -0.5, 0.2, 0.7).normalized().toRotationMatrix();
  for (const Vec3& d : diagonals)
    for (const Real lambda : {-0.3, 0.0, 1.0, 50.0}) {
      Mat3 strain[lanes];
      strain[0] = d.asDiagonal();
      strain[1] = turn * d.asDiagonal() * turn.transpose();
      strain[2] = -strain[1];
      strain[3] = Mat3::Zero();
      compare(strain, 1, lambda);
    }
}

TEST(TwistStiffness, NothingNegativeEvenWhereElementsAreCrushed) {
  for (const Real crushed : {-0.6, -0.9, -1.0, -1.5, -3.0}) {
    const Lanes zero{};
    const Lanes E[6] = {zero + crushed, zero + 0.1, zero + crushed, zero + 0.05, zero, zero};
    Lanes G[6];
    twist_stiffness(E, zero + 1.0, zero + 4.0, G);
    Mat3 g;
    g << G[0][0], G[3][0], G[4][0], G[3][0], G[1][0], G[5][0], G[4][0], G[5][0], G[2][0];
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Mat3>(g).eigenvalues().minCoeff(), -1e-8) << crushed;
  }
}

}  // namespace
}  // namespace sutura::tissue
