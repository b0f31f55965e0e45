// Have two curves gone through each other between two states? Without any of the code that prevents
// it: by the Gauss integral, which counts how often one turns round the other, and jumps by one
// where they cross.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sutura/geometry/curve_segments.h"

namespace sutura::testing {

using Line = std::vector<Vec3>;

inline Line line_of(const SegmentedCurve& curve, int parts = 3) {
  std::vector<CurveSegment> segments;
  curve.segments(Configuration::current, segments);
  Line line;
  for (const CurveSegment& s : segments)
    for (int k = 0; k < parts; ++k) line.push_back(s.point(Real(k) / parts));
  line.push_back(segments.back().xb);
  return line;
}

/// Signed solid angle under which one segment sees the other (Klenin and Langowski 2000, method 1a).
inline Real solid_angle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 ac = c - a, ad = d - a, bc = c - b, bd = d - b;
  const Vec3 n[4] = {ac.cross(ad).normalized(), ad.cross(bd).normalized(),
                     bd.cross(bc).normalized(), bc.cross(ac).normalized()};
  Real sum = 0;
  for (int k = 0; k < 4; ++k) sum += std::asin(std::clamp(n[k].dot(n[(k + 1) % 4]), -1., 1.));
  const Real side = (d - c).cross(b - a).dot(ac);
  return side > 0 ? sum : side < 0 ? -sum : 0;
}

/// Of two lines, or of one with itself (then each pair counts once).
inline Real gauss_integral(const Line& a, const Line& b, bool self) {
  Real sum = 0;
  for (std::size_t i = 0; i + 1 < a.size(); ++i)
    for (std::size_t j = self ? i + 2 : 0; j + 1 < b.size(); ++j)
      sum += solid_angle(a[i], a[i + 1], b[j], b[j + 1]);
  return sum / (4 * std::numbers::pi);
}

/// Number of times that the straight way from one state to the other leads them through each other.
inline int crossings(const Line& a0, const Line& a1, const Line& b0, const Line& b1, bool self) {
  Real motion = 0;
  for (std::size_t i = 0; i < a0.size(); ++i) motion = std::max(motion, (a1[i] - a0[i]).norm());
  for (std::size_t i = 0; i < b0.size(); ++i) motion = std::max(motion, (b1[i] - b0[i]).norm());
  constexpr Real small = 0.05e-3;  // m: a fraction of a thread; what is smooth changes little in it
  const int parts = std::clamp(static_cast<int>(motion / small), 1, 400);
  const auto at = [&](const Line& from, const Line& to, int k) {
    Line out(from.size());
    for (std::size_t i = 0; i < from.size(); ++i)
      out[i] = from[i] + (to[i] - from[i]) * (Real(k) / parts);
    return out;
  };
  int count = 0;
  Real before = gauss_integral(a0, b0, self);
  for (int k = 1; k <= parts; ++k) {
    const Line a = at(a0, a1, k);
    const Real now = gauss_integral(a, self ? a : at(b0, b1, k), self);
    count += std::abs(now - before) > 0.5;
    before = now;
  }
  return count;
}

}  // namespace sutura::testing
