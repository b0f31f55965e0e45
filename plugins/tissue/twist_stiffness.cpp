#include "twist_stiffness.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace sutura::tissue {
namespace {

/// The cofactors of a symmetric matrix (entries xx yy zz xy xz yz).
void cofactors(const Lanes (&a)[6], Lanes (&C)[6]) {
  C[0] = a[1] * a[2] - a[5] * a[5];
  C[1] = a[0] * a[2] - a[4] * a[4];
  C[2] = a[0] * a[1] - a[3] * a[3];
  C[3] = a[4] * a[5] - a[3] * a[2];
  C[4] = a[3] * a[5] - a[1] * a[4];
  C[5] = a[3] * a[4] - a[5] * a[0];
}

Lanes squared_norm(const Lanes (&a)[6]) {
  return a[0] * a[0] + a[1] * a[1] + a[2] * a[2] + 2.0 * (a[3] * a[3] + a[4] * a[4] + a[5] * a[5]);
}

Lanes square_root(Lanes a) {
  for (int k = 0; k < lanes; ++k) a[k] = std::sqrt(a[k]);
  return a;
}

/// P <- (G + |G|) / 2, which is G with zeros for its negative eigenvalues. |G| is G times its sign,
/// and the sign is the limit of Newton's X <- (X + X^-1) / 2 from X = G, here with X scaled by the
/// ratio of the norms of X^-1 and X (Higham, Functions of Matrices, 2008, section 5.5). Where an
/// eigenvalue is smaller than `tiny`, P has some number between zero and it.
void positive_part(const Lanes (&G)[6], const Lanes& tiny, Lanes (&P)[6]) {
  constexpr int iterations = 9;
  Lanes X[6], C[6];
  for (int i = 0; i < 6; ++i) X[i] = G[i];
  // No eigenvalue is exactly zero.
  for (int i = 0; i < 3; ++i) X[i] += tiny;
  for (int n = 0; n < iterations; ++n) {
    cofactors(X, C);
    Lanes determinant = X[0] * C[0] + X[3] * C[3] + X[4] * C[4];
    const Lanes least = tiny * tiny * tiny;
    determinant = choose(determinant * determinant > least * least, determinant, least);
    const Lanes inverse = 1.0 / determinant;
    const Lanes scale =
        square_root(square_root(squared_norm(C) * inverse * inverse / squared_norm(X)));
    const Lanes keep = 0.5 * scale, turn = 0.5 * inverse / scale;
    for (int i = 0; i < 6; ++i) X[i] = keep * X[i] + turn * C[i];
  }
  const Lanes g[3][3] = {{G[0], G[3], G[4]}, {G[3], G[1], G[5]}, {G[4], G[5], G[2]}};
  const Lanes x[3][3] = {{X[0], X[3], X[4]}, {X[3], X[1], X[5]}, {X[4], X[5], X[2]}};
  const auto entry = [&](int i, int j) {
    return 0.5 * (g[i][j] + g[i][0] * x[0][j] + g[i][1] * x[1][j] + g[i][2] * x[2][j]);
  };
  P[0] = entry(0, 0);
  P[1] = entry(1, 1);
  P[2] = entry(2, 2);
  P[3] = entry(0, 1);
  P[4] = entry(0, 2);
  P[5] = entry(1, 2);
}

/// The same for one lane, whatever G is; no eigenvalue above `most`.
void positive_part_of_lane(Lanes (&G)[6], Real most, int k) {
  Mat3 g;
  g << G[0][k], G[3][k], G[4][k], G[3][k], G[1][k], G[5][k], G[4][k], G[5][k], G[2][k];
  Mat3 raised = Mat3::Zero();
  if (g.allFinite()) {
    Eigen::SelfAdjointEigenSolver<Mat3> eigen;
    eigen.computeDirect(g);
    const Vec3 values = eigen.eigenvalues().cwiseMax(0).cwiseMin(most);
    raised = eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
  }
  G[0][k] = raised(0, 0);
  G[1][k] = raised(1, 1);
  G[2][k] = raised(2, 2);
  G[3][k] = raised(0, 1);
  G[4][k] = raised(0, 2);
  G[5][k] = raised(1, 2);
}

}  // namespace

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

  // Strains up to a half: N is far from singular and G from its bound.
  const auto moderate = squared_norm(E) < 0.25;
  Lanes P[6];
  positive_part(G, tiny, P);
  for (int i = 0; i < 6; ++i) G[i] = choose(refused & moderate, P[i], G[i]);
  const LaneMask wild = refused & ~moderate;
  if (!any_lane(wild)) return;
  for (int k = 0; k < lanes; ++k)
    if (wild[k] != 0) positive_part_of_lane(G, 4 * modulus[k], k);
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
