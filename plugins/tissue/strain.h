// Rotation and strain of four deformation gradients at once.
#pragma once

#include "lanes.h"
#include "rotation.h"

namespace sutura::tissue {

/// R of four gradients; the lanes that the closed form refuses go one by one through the SVD.
inline void rotations(const Small3<Lanes>& F, Small3<Lanes>& R) {
  const LaneMask refused = rotation_closed_form(F, R);
  if (!any_lane(refused)) return;
  for (int k = 0; k < lanes; ++k) {
    if (refused[k] == 0) continue;
    Mat3 f;
    for (int i = 0; i < 9; ++i) f.data()[i] = F[i][k];
    const Mat3 r = rotation_by_svd(f);
    for (int i = 0; i < 9; ++i) R[i][k] = r.data()[i];
  }
}

/// E = sym(R^T F) - I: entries xx yy zz xy xz yz.
inline void biot_strain(const Small3<Lanes>& F, const Small3<Lanes>& R, Lanes (&E)[6]) {
  const auto dot = [&](int i, int j) {
    return R[3 * i] * F[3 * j] + R[3 * i + 1] * F[3 * j + 1] + R[3 * i + 2] * F[3 * j + 2];
  };
  for (int i = 0; i < 3; ++i) E[i] = dot(i, i) - 1.0;
  E[3] = 0.5 * (dot(0, 1) + dot(1, 0));
  E[4] = 0.5 * (dot(0, 2) + dot(2, 0));
  E[5] = 0.5 * (dot(1, 2) + dot(2, 1));
}

/// E + beta/h (E - start) is (E - share start) / (1 - share), with share = beta/(h + beta): takes E
/// to the bracket and returns the factor.
inline Real add_viscosity(Real share, const Lanes (&start)[6], Lanes (&E)[6]) {
  if (share == 0) return 1;
  for (int i = 0; i < 6; ++i) E[i] -= share * start[i];
  return 1 / (1 - share);
}

}  // namespace sutura::tissue
