#include "twist_stiffness.h"

#include <Eigen/Eigenvalues>

namespace sutura::tissue {

void twist_stiffness(const Lanes (&E)[6], const Lanes& mu, const Lanes& lambda, Lanes (&G)[6]) {
  // N = tr S I - S, its inverse by cofactors.
  const Lanes trace = E[0] + E[1] + E[2];
  const Lanes a = 2.0 + trace - E[0], b = 2.0 + trace - E[1], c = 2.0 + trace - E[2];
  const Lanes d = -E[3], e = -E[4], f = -E[5];
  const Lanes C[6] = {b * c - f * f, a * c - e * e, a * b - d * d,
                      e * f - d * c, d * f - b * e, d * e - a * f};
  const Lanes determinant = a * C[0] + d * C[3] + e * C[4];
  const Lanes factor = 2.0 * (lambda * trace - 2.0 * mu) / determinant;
  for (int i = 0; i < 6; ++i) G[i] = factor * C[i];
  for (int i = 0; i < 3; ++i) G[i] += 2.0 * mu;

  // Positive semidefinite as it is? Leading minors tell; the others go one by one. Rounding at rest
  // is no compression.
  const Lanes modulus = mu + choose(lambda > 0.0, lambda, -lambda);
  const Lanes tiny = 1e-9 * modulus;
  const Lanes minor = (G[0] + tiny) * (G[1] + tiny) - G[3] * G[3];
  const Lanes whole = (G[0] + tiny) * ((G[1] + tiny) * (G[2] + tiny) - G[5] * G[5]) -
                      G[3] * (G[3] * (G[2] + tiny) - G[5] * G[4]) +
                      G[4] * (G[3] * G[5] - (G[1] + tiny) * G[4]);
  const auto fine = (G[0] + tiny >= 0.0) & (minor >= 0.0) & (whole >= 0.0) & (determinant > 0.0);
  const LaneMask refused = fine == 0;
  if (!any_lane(refused)) return;
  for (int k = 0; k < lanes; ++k) {
    if (refused[k] == 0) continue;
    Mat3 g;
    g << G[0][k], G[3][k], G[4][k], G[3][k], G[1][k], G[5][k], G[4][k], G[5][k], G[2][k];
    Mat3 raised = Mat3::Zero();
    if (g.allFinite()) {
      Eigen::SelfAdjointEigenSolver<Mat3> eigen;
      eigen.computeDirect(g);
      const Vec3 values = eigen.eigenvalues().cwiseMax(0).cwiseMin(4 * modulus[k]);
      raised = eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
    }
    G[0][k] = raised(0, 0);
    G[1][k] = raised(1, 1);
    G[2][k] = raised(2, 2);
    G[3][k] = raised(0, 1);
    G[4][k] = raised(0, 2);
    G[5][k] = raised(1, 2);
  }
}

void turn_symmetric(const Lanes* R, Lanes (&G)[6]) {
  const Lanes g[3][3] = {{G[0], G[3], G[4]}, {G[3], G[1], G[5]}, {G[4], G[5], G[2]}};
  Lanes rg[3][3];  // R is column by column
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rg[i][j] = R[i] * g[0][j] + R[3 + i] * g[1][j] + R[6 + i] * g[2][j];
  const auto entry = [&](int i, int j) {
    return rg[i][0] * R[j] + rg[i][1] * R[3 + j] + rg[i][2] * R[6 + j];
  };
  G[0] = entry(0, 0);
  G[1] = entry(1, 1);
  G[2] = entry(2, 2);
  G[3] = entry(0, 1);
  G[4] = entry(0, 2);
  G[5] = entry(1, 2);
}

}  // namespace sutura::tissue
