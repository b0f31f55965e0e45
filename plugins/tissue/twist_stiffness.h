// What stretch adds to the tangent stiffness of a corotational element.
//
// The energy density is W = mu |S - I|^2 + lambda/2 (tr S)^2 with F = R S and tr S taken from its
// rest value. The usual tangent turns the linear one with R and has no stiffness at all against
// twist, the three modes in which R itself turns; where the element is stretched the exact Hessian
// has. Its part beyond the usual one, between nodes with gradients g_a and g_b in the rest frame,
// is
//   K_ab = V/2 R [g_a]x G [g_b]x^T R^T,     G = 2 mu I + 2 (lambda (tr S - 3) - 2 mu) (tr S I -
//   S)^-1
// ([g]x: matrix of the cross product; the eigenvalues of G are those of the twist modes, 2 mu + c_i
// in Smith, de Goes and Kim 2019). Negative eigenvalues, of compression, are raised to zero, so
// that the matrix of a step stays positive definite.
#pragma once

#include "lanes.h"
#include "sutura/types.h"

namespace sutura::tissue {

/// G times volume, entries xx yy zz xy xz yz, from the strain E = S - I (same order) and moduli
/// times volume. `mu` is that of the term 2 mu |S - I|^2 and `lambda` that of the trace.
void twist_stiffness(const Lanes (&E)[6], const Lanes& mu, const Lanes& lambda, Lanes (&G)[6]);

/// K (row by row) += R [a]x G [b]x^T R^T, where `ra` and `rb` are a and b turned by R and `G` has
/// been turned by it too.
inline void add_twist(const Lanes (&G)[6], const Lanes* ra, const Lanes* rb, Lanes (&K)[9]) {
  // [a]x G, row by row.
  const Lanes g[3][3] = {{G[0], G[3], G[4]}, {G[3], G[1], G[5]}, {G[4], G[5], G[2]}};
  Lanes m[3][3];
  for (int j = 0; j < 3; ++j) {
    m[0][j] = ra[1] * g[2][j] - ra[2] * g[1][j];
    m[1][j] = ra[2] * g[0][j] - ra[0] * g[2][j];
    m[2][j] = ra[0] * g[1][j] - ra[1] * g[0][j];
  }
  // times [b]x^T: row i of the product is b x (row i of m).
  for (int i = 0; i < 3; ++i) {
    K[3 * i] += rb[1] * m[i][2] - rb[2] * m[i][1];
    K[3 * i + 1] += rb[2] * m[i][0] - rb[0] * m[i][2];
    K[3 * i + 2] += rb[0] * m[i][1] - rb[1] * m[i][0];
  }
  if (ra != rb) return;
  K[3] = K[1];  // symmetric to the last bit
  K[6] = K[2];
  K[7] = K[5];
}

/// R G R^T.
void turn_symmetric(const Lanes* R, Lanes (&G)[6]);

}  // namespace sutura::tissue
