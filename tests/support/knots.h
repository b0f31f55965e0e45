// How closed lines are linked and knotted: numbers that no motion changes as long as nothing passes
// through anything. Lines are closed polygons; the last point is joined to the first.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <ostream>
#include <vector>

#include "sutura/types.h"

namespace sutura::testing {

/// Gauss's integral over two closed lines: the signed solid angle under which each edge sees the
/// other, over 4 pi (Klenin and Langowski 2000, "Computation of writhe in modeling of supercoiled
/// DNA", eq. 15 and 16). An integer up to rounding.
inline Real linking_number(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  Real sum = 0;
  const auto sine = [](Real x) { return std::asin(std::clamp(x, -1., 1.)); };
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Vec3 &p = a[i], &q = a[(i + 1) % a.size()];
      const Vec3 &r = b[j], &s = b[(j + 1) % b.size()];
      const Vec3 pr = r - p, ps = s - p, qr = r - q, qs = s - q;
      Vec3 n[] = {pr.cross(ps), ps.cross(qs), qs.cross(qr), qr.cross(pr)};
      for (Vec3& each : n) {
        const Real length = each.norm();
        if (length > 0) each /= length;
      }
      const Real angle =
          sine(n[0].dot(n[1])) + sine(n[1].dot(n[2])) + sine(n[2].dot(n[3])) + sine(n[3].dot(n[0]));
      sum += std::copysign(angle, (s - r).cross(q - p).dot(pr));
    }
  return sum / (4 * std::numbers::pi);
}

/// Size of the Alexander polynomial of a closed line at -1 (the determinant of the knot) and at a
/// primitive cube root of unity. The polynomial is known up to a factor of a power of t only, which
/// at these has the size 1. 1 and 1 for a line without a knot.
struct KnotInvariant {
  Real at_minus_one = 1, at_cube_root = 1;
  bool operator==(const KnotInvariant& other) const {
    constexpr Real rounding = 1e-6;
    return std::abs(at_minus_one - other.at_minus_one) < rounding * (1 + at_minus_one) &&
           std::abs(at_cube_root - other.at_cube_root) < rounding * (1 + at_cube_root);
  }
  friend std::ostream& operator<<(std::ostream& out, const KnotInvariant& k) {
    return out << k.at_minus_one << " and " << k.at_cube_root;
  }
};

namespace knots {

/// Where the drawing of a line crosses itself.
struct Crossing {
  Real over = 0, under = 0;  ///< places along the line: number of the edge and part of it
  int sign = 1;
};

/// In the drawing onto the x y plane.
inline std::vector<Crossing> crossings_of_drawing(const std::vector<Vec3>& line) {
  std::vector<Crossing> out;
  const std::size_t n = line.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours
      const Vec3 &p = line[i], &q = line[(i + 1) % n], &r = line[j], &s = line[(j + 1) % n];
      const auto area = [](const Vec3& u, const Vec3& v) { return u.x() * v.y() - u.y() * v.x(); };
      const Vec3 along = q - p, other = s - r;
      const Real turn = area(along, other);
      if (turn == 0) continue;
      const Real u = area(r - p, other) / turn, v = area(r - p, along) / turn;
      if (!(u >= 0 && u < 1 && v >= 0 && v < 1)) continue;
      const Real height = p.z() + u * along.z() - (r.z() + v * other.z());
      const Real here = static_cast<Real>(i) + u, there = static_cast<Real>(j) + v;
      const bool first_is_over = height > 0;
      out.push_back({first_is_over ? here : there, first_is_over ? there : here,
                     (turn > 0) == first_is_over ? 1 : -1});
    }
  return out;
}

/// |Alexander polynomial at t| for |t| = 1, from the arcs between passages below: one row for each
/// crossing, less one row and one column.
inline Real alexander(std::vector<Crossing> crossings, std::complex<Real> t) {
  const auto count = static_cast<Index>(crossings.size());
  if (count < 2) return 1;
  std::sort(crossings.begin(), crossings.end(),
            [](const Crossing& a, const Crossing& b) { return a.under < b.under; });
  // Arc i ends where the line passes below at crossing i.
  const auto arc = [&](Real place) {
    const auto it = std::lower_bound(crossings.begin(), crossings.end(), place,
                                     [](const Crossing& c, Real at) { return c.under < at; });
    return (it - crossings.begin()) % count;
  };
  Eigen::MatrixXcd rows = Eigen::MatrixXcd::Zero(count, count);
  for (Index i = 0; i < count; ++i) {
    const Crossing& c = crossings[static_cast<std::size_t>(i)];
    const Index in = i, out = (i + 1) % count;
    rows(i, arc(c.over)) += 1. - t;
    rows(i, c.sign > 0 ? in : out) += t;
    rows(i, c.sign > 0 ? out : in) -= 1.;
  }
  return std::abs(Eigen::MatrixXcd(rows.topLeftCorner(count - 1, count - 1)).determinant());
}

}  // namespace knots

inline KnotInvariant knot_invariant(std::vector<Vec3> line) {
  // No edge of a line that stands along the axes of the world lies along the drawing's.
  const Mat3 turned = Quat(Eigen::AngleAxis<Real>(0.7, Vec3(0.36, -0.48, 0.8))).toRotationMatrix();
  for (Vec3& p : line) p = turned * p;
  const auto crossings = knots::crossings_of_drawing(line);
  constexpr Real third = 2 * std::numbers::pi / 3;
  return {knots::alexander(crossings, -1.), knots::alexander(crossings, std::polar(1., third))};
}

}  // namespace sutura::testing
