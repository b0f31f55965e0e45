// A thread that is laid out as a loose overhand knot, or as the same curve without a knot.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <string>

#include "sutura/types.h"

namespace sutura::testing {

/// A polynomial curve that comes from far away and goes far away: Shastri's trefoil (1992,
/// "Polynomial representations of knots"), or, drawn by the same line, one without a knot: it only
/// climbs. There one pass of a strand through another ties the knot.
inline Vec3 long_curve(Real t, bool is_knot) {
  const Real t2 = t * t, z = is_knot ? 0.25 * (t2 * t2 - 10) * t : 0.8 * t;
  return Vec3((t2 - 3) * t, (t2 - 4) * t2, z);
}

/// As a table of curvature and torsion, for a thread of `length` (m) that is `scale` (m) large,
/// with `straight` ends (m).
struct LaidOut {
  std::string file;
  Real length = 0;
};
inline LaidOut lay_out(bool is_knot, Real scale, Real end, Real straight = 0) {
  // A file for each test, as tests run beside each other.
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string(test->test_suite_name()) + "_" + test->name();
  std::replace(name.begin(), name.end(), '/', '_');
  LaidOut out{SUTURA_BINARY_DIR "/" + name + std::to_string(is_knot) + ".csv"};
  std::ofstream file(out.file);
  file << std::setprecision(17) << "s [m],curvature [1/m],torsion [1/m]\n";
  if (straight > 0) file << "0,0,0\n";
  out.length = straight;
  constexpr int rows = 2000;
  const Real h = 2 * end / rows;
  for (int i = 0; i < rows; ++i) {
    const Real t = -end + (i + 0.5) * h;
    Vec3 p[5];  // central differences, exact enough for polynomials of the fifth degree
    for (int k = 0; k < 5; ++k) p[k] = scale * long_curve(t + (k - 2) * 1e-2, is_knot);
    const Vec3 d1 = (p[3] - p[1]) / 2e-2, d2 = (p[3] - 2 * p[2] + p[1]) / 1e-4,
               d3 = (p[4] - 2 * p[3] + 2 * p[1] - p[0]) / 2e-6;
    const Vec3 bend = d1.cross(d2);
    file << out.length << ',' << bend.norm() / std::pow(d1.norm(), 3) << ','
         << bend.dot(d3) / bend.squaredNorm() << '\n';
    out.length += h * d1.norm();
  }
  if (straight > 0) file << out.length << ",0,0\n";
  out.length += straight;
  return out;
}

}  // namespace sutura::testing
