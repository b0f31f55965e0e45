// Have two curves gone through each other between two states? Without any of the code that prevents
// it: by the Gauss integral, which counts how often one turns round the other, and jumps by one
// where they cross.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
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

/// Signed solid angle under which one segment sees the other (Klenin and Langowski 2000, method
/// 1a).
inline Real solid_angle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 ac = c - a, ad = d - a, bc = c - b, bd = d - b;
  const Vec3 n[4] = {ac.cross(ad).normalized(), ad.cross(bd).normalized(),
                     bd.cross(bc).normalized(), bc.cross(ac).normalized()};
  Real sum = 0;
  for (int k = 0; k < 4; ++k) sum += std::asin(std::clamp(n[k].dot(n[(k + 1) % 4]), -1., 1.));
  const Real side = (d - c).cross(b - a).dot(ac);
  return side > 0 ? sum : side < 0 ? -sum : 0;
}

/// Pairs of segments of two lines (of one with itself each pair once) whose ways come close.
using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;
inline Pairs close_pairs(const Line& a0, const Line& a1, const Line& b0, const Line& b1,
                         bool self) {
  constexpr Real margin = 0.2e-3;  // m
  const auto box = [](const Line& x, const Line& y, std::size_t i) {
    Eigen::AlignedBox<Real, 3> all(x[i]);
    all.extend(x[i + 1]), all.extend(y[i]), all.extend(y[i + 1]);
    return all;
  };
  Pairs pairs;
  for (std::size_t i = 0; i + 1 < a0.size(); ++i) {
    const auto mine = box(a0, a1, i);
    for (std::size_t j = self ? i + 2 : 0; j + 1 < b0.size(); ++j)
      if (mine.exteriorDistance(box(b0, b1, j)) < margin) pairs.emplace_back(i, j);
  }
  return pairs;
}

inline Real gauss_integral(const Line& a, const Line& b, const Pairs& pairs) {
  Real sum = 0;
  for (const auto& [i, j] : pairs) sum += solid_angle(a[i], a[i + 1], b[j], b[j + 1]);
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
  const Pairs pairs = close_pairs(a0, a1, b0, b1, self);
  int count = 0;
  Real before = gauss_integral(a0, b0, pairs);
  for (int k = 1; k <= parts; ++k) {
    const Line a = at(a0, a1, k);
    const Real now = gauss_integral(a, self ? a : at(b0, b1, k), pairs);
    count += std::abs(now - before) > 0.5;
    before = now;
  }
  return count;
}

}  // namespace sutura::testing
