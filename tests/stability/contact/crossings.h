// Have two curves gone through each other between two states? Without any of the code that prevents
// it: two segments whose ends go straight lie in one plane where the volume of their tetrahedron,
// a cubic of time, is zero; there they cross or they do not.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sutura/geometry/curve_segments.h"
#include "sutura/geometry/distances.h"

namespace sutura::testing {

using Line = std::vector<Vec3>;

/// `parts`: of each beam. A straight part must miss the curve by less than the thread is thick.
constexpr int parts_of_beam = 16;

inline Line line_of(const SegmentedCurve& curve, int parts = parts_of_beam) {
  std::vector<CurveSegment> segments;
  curve.segments(Configuration::current, segments);
  Line line;
  for (const CurveSegment& s : segments)
    for (int k = 0; k < parts; ++k) line.push_back(s.point(Real(k) / parts));
  line.push_back(segments.back().xb);
  return line;
}

/// Times in [0, 1] at which the cubic a[0] + a[1] t + a[2] t^2 + a[3] t^3 changes sign.
inline std::vector<Real> sign_changes(const std::array<Real, 4>& a) {
  const auto at = [&](Real t) { return a[0] + t * (a[1] + t * (a[2] + t * a[3])); };
  std::vector<Real> turns{0, 1}, roots;
  const Real p = 3 * a[3], q = a[2], d = q * q - p * a[1];
  if (d > 0) {
    // The two roots of p t^2 + 2 q t + a[1], without cancellation.
    const Real w = -(q + std::copysign(std::sqrt(d), q));
    for (const Real t : {w / p, a[1] / w})
      if (t > 0 && t < 1) turns.push_back(t);
  }
  std::sort(turns.begin(), turns.end());
  for (std::size_t i = 0; i + 1 < turns.size(); ++i) {
    Real low = turns[i], high = turns[i + 1];
    const bool rises = at(low) < 0;
    if (rises == (at(high) < 0)) continue;
    for (int k = 0; k < 60; ++k) {
      const Real middle = (low + high) / 2;
      ((at(middle) < 0) == rises ? low : high) = middle;
    }
    roots.push_back(low);
  }
  return roots;
}

/// How often the segment from p[0] to p[1] goes through that from p[2] to p[3], on the way to q.
inline int crossings_of(const std::array<Vec3, 4>& p, const std::array<Vec3, 4>& q) {
  // Sides of the tetrahedron: u + t du and so on.
  const Vec3 u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0];
  const Vec3 du = q[1] - q[0] - u, dv = q[2] - q[0] - v, dw = q[3] - q[0] - w;
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c) { return a.dot(b.cross(c)); };
  const auto times =
      sign_changes({volume(u, v, w), volume(du, v, w) + volume(u, dv, w) + volume(u, v, dw),
                    volume(u, dv, dw) + volume(du, v, dw) + volume(du, dv, w), volume(du, dv, dw)});
  int count = 0;
  for (const Real t : times) {
    const auto at = [&](std::size_t i) { return Vec3(p[i] + t * (q[i] - p[i])); };
    constexpr Real rounding = 1e-9;  // m
    const SegmentPair near = closest_points(Segment{at(0), at(1)}, Segment{at(2), at(3)});
    count += near.squared_distance < rounding * rounding;
  }
  return count;
}

/// How often the straight way from one state to the other leads parts of two lines (`self`: of one)
/// through each other. Beams that share a node are left out: they never touch each other
/// (docs/theory/contact.md); `parts` are those of line_of.
inline int crossings(const Line& a0, const Line& a1, const Line& b0, const Line& b1, bool self,
                     int parts = parts_of_beam) {
  using Bounds = Eigen::AlignedBox<Real, 3>;
  const auto around = [](const Line& x, const Line& y, std::size_t i) {
    Bounds all(x[i]);
    all.extend(x[i + 1]), all.extend(y[i]), all.extend(y[i + 1]);
    return all;
  };
  std::vector<Bounds> others;
  for (std::size_t j = 0; j + 1 < b0.size(); ++j) others.push_back(around(b0, b1, j));
  const auto beam = static_cast<std::size_t>(parts);
  int count = 0;
  for (std::size_t i = 0; i + 1 < a0.size(); ++i) {
    const Bounds mine = around(a0, a1, i);
    for (std::size_t j = self ? (i / beam + 2) * beam : 0; j < others.size(); ++j)
      if (mine.intersects(others[j]))
        count += crossings_of({a0[i], a0[i + 1], b0[j], b0[j + 1]},
                              {a1[i], a1[i + 1], b1[j], b1[j + 1]});
  }
  return count;
}

}  // namespace sutura::testing
