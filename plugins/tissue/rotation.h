// The rotation nearest to a deformation gradient, with the sign on the smallest singular value.
#pragma once

#include <array>

#include "lanes.h"
#include "sutura/types.h"

namespace sutura::tissue {

/// argmax tr(R^T F) over rotations, through the singular values: right for every F, also singular
/// or inverted ones, and slow. Where several rotations are equally near (F = 0, say) it takes one
/// of them, always the same; if F is not finite, the identity.
Mat3 rotation_by_svd(const Mat3& F);

/// Small matrices in registers: entry (i, j) of a 3x3 matrix is m[3 j + i], as Mat3 stores it.
template <class S>
using Small3 = std::array<S, 9>;

/// The same in closed form, for one matrix (S = Real) or several at once (S = Lanes). With signed
/// singular values s_i, l = s_1 + s_2 + s_3 is the largest root of
///   p(l) = (l^2 - a)^2 - 8 d l - 4 c,   a = |F|^2, d = det F, c = |cof F|^2,
/// the characteristic polynomial of the 4x4 matrix of Horn (1987), and R = dl/dF, that is
///   R = ((l^2 + a) F + 2 l cof F - 2 F F^T F) / (l (l^2 - a) - 2 d)
/// (the derivative used by Lin, Kim, Twigg and Levin, 2022). The denominator is
/// 2 (s_1 + s_2)(s_1 + s_3)(s_2 + s_3): where it vanishes the rotation is not unique.
/// p is convex beyond its largest root, so Newton's method from above descends to it, and no start
/// value is carried from step to step: 180 degrees are no worse than 0.
/// Returns the lanes that are too close to a vanishing denominator, to be done by rotation_by_svd.
template <class S>
auto rotation_closed_form(const Small3<S>& F, Small3<S>& R) {
  Small3<S> C;  // cofactors, column by column
  for (int j = 0; j < 3; ++j) {
    const int u = 3 * ((j + 1) % 3), v = 3 * ((j + 2) % 3);
    C[3 * j] = F[u + 1] * F[v + 2] - F[u + 2] * F[v + 1];
    C[3 * j + 1] = F[u + 2] * F[v] - F[u] * F[v + 2];
    C[3 * j + 2] = F[u] * F[v + 1] - F[u + 1] * F[v];
  }
  S a = F[0] * F[0], c = C[0] * C[0];
  for (int i = 1; i < 9; ++i) {
    a += F[i] * F[i];
    c += C[i] * C[i];
  }
  const S d = F[0] * C[0] + F[1] * C[1] + F[2] * C[2];

  // s_1 + s_2 + s_3 <= sqrt(3 a) <= (a + 3) / 2: no square root, and exact at a pure rotation.
  S l = (a + 3.0) * 0.5;
  S slope = l;
  for (int i = 0; i < 60; ++i) {
    const S q = l * l - a;
    slope = 4.0 * l * q - 8.0 * d;
    const S step = (q * q - 8.0 * d * l - 4.0 * c) / slope;
    l -= choose(step > 0.0, step, S{} * step);  // NaN stays NaN and is left to the caller
    // Convergence is quadratic: after a relative step of 1e-8 the next is below rounding.
    if (!any_lane(step > 1e-8 * l)) break;
  }
  const S q = l * l - a;
  slope = l * q - 2.0 * d;
  const S inverse = 1.0 / slope;

  Small3<S> FtF;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j)
      FtF[3 * j + i] = FtF[3 * i + j] =
          F[3 * i] * F[3 * j] + F[3 * i + 1] * F[3 * j + 1] + F[3 * i + 2] * F[3 * j + 2];
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      const S cubic = F[i] * FtF[3 * j] + F[3 + i] * FtF[3 * j + 1] + F[6 + i] * FtF[3 * j + 2];
      R[3 * j + i] = ((l * l + a) * F[3 * j + i] + 2.0 * (l * C[3 * j + i] - cubic)) * inverse;
    }
  // The error of R grows like rounding / (slope / |F|^3)^2: refuse below 0.01 (3.1 at rest), and
  // where l has not come down to its bound yet.
  const auto fine = (slope > 0.0) & (slope * slope > 1e-4 * a * a * a) & (l * l < 3.0001 * a);
  return fine == 0;
}

/// For one matrix: closed form where it is accurate, singular values elsewhere.
Mat3 nearest_rotation(const Mat3& F);

}  // namespace sutura::tissue
