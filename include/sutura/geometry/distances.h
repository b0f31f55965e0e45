// Closest points: of a triangle to a point, of two segments, of a segment and a triangle. Each case
// is the minimum of a convex function: where the minimum over the whole line or plane lies outside,
// the minimum lies on the border, and the pieces of the border are tried one by one. Segments of
// length zero and flat triangles are allowed.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "sutura/types.h"

namespace sutura {

using Corners = std::array<Vec3, 3>;  ///< of a triangle (m)

struct Segment {
  Vec3 a, b;  ///< ends (m)
  Vec3 at(Real s) const { return a + s * (b - a); }
};

/// s in [0, 1]: the point of the segment closest to p is `segment.at(s)`.
inline Real closest_point(const Vec3& p, const Segment& segment) {
  const Vec3 along = segment.b - segment.a;
  const Real length = along.squaredNorm();
  return length > 0 ? std::clamp((p - segment.a).dot(along) / length, 0.0, 1.0) : 0;
}

/// A point of a triangle, and whether it lies inside, on an edge or at a corner.
struct TrianglePoint {
  Vec3 weights = Vec3::Zero();  ///< barycentric; exactly zero off the edge or corner
  int edge = -1;                ///< 0: corners 0 1, 1: 1 2, 2: 2 0
  int corner = -1;
  Vec3 on(const Corners& t) const {
    return weights[0] * t[0] + weights[1] * t[1] + weights[2] * t[2];
  }
};

/// The point of the triangle closest to p.
inline TrianglePoint closest_point(const Vec3& p, const Corners& t) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0], n = u.cross(v);
  const Real area = n.squaredNorm();
  if (area > 0) {
    const Vec3 r = p - t[0];
    const Real w2 = u.cross(r).dot(n) / area, w1 = r.cross(v).dot(n) / area;
    if (w1 > 0 && w2 > 0 && w1 + w2 < 1) return {Vec3(1 - w1 - w2, w1, w2)};
  }
  TrianglePoint best;
  Real least = std::numeric_limits<Real>::infinity();
  for (int e = 0; e < 3; ++e) {
    const std::size_t i = static_cast<std::size_t>(e), j = (i + 1) % 3;
    const Segment edge{t[i], t[j]};
    const Real s = closest_point(p, edge);
    const Real distance = (edge.at(s) - p).squaredNorm();
    if (!(distance < least)) continue;
    least = distance;
    best = {};
    best.weights[e] = 1 - s;
    best.weights[(e + 1) % 3] = s;
    if (s == 0)
      best.corner = e;
    else if (s == 1)
      best.corner = (e + 1) % 3;
    else
      best.edge = e;
  }
  return best;
}

struct SegmentPair {
  Real s = 0, t = 0;  ///< the points are p.at(s) and q.at(t)
  Real squared_distance = std::numeric_limits<Real>::infinity();  ///< m^2
};

/// The points of two segments closest to each other. Of parallel ones, any such pair.
inline SegmentPair closest_points(const Segment& p, const Segment& q) {
  const Vec3 u = p.b - p.a, v = q.b - q.a, n = u.cross(v);
  const Real sine = n.squaredNorm(), length = v.squaredNorm();
  SegmentPair best;
  const auto try_pair = [&](Real s, Real t) {
    const Real d = (p.at(s) - q.at(t)).squaredNorm();
    if (d < best.squared_distance) best = {s, t, d};
  };
  if (sine > 0 && length > 0) {
    // For nearly parallel segments s is mostly rounding, and hardly matters as long as t belongs to
    // it.
    const Real s = (q.a - p.a).cross(v).dot(n) / sine;
    const Real t = (p.at(s) - q.a).dot(v) / length;
    if (s > 0 && s < 1 && t > 0 && t < 1) try_pair(s, t);
    if (best.squared_distance < std::numeric_limits<Real>::infinity()) return best;
  }
  try_pair(0, closest_point(p.a, q));
  try_pair(1, closest_point(p.b, q));
  try_pair(closest_point(q.a, p), 0);
  try_pair(closest_point(q.b, p), 1);
  return best;
}

struct SegmentTriangle {
  Real s = 0;                   ///< the point of the segment is segment.at(s)
  Vec3 weights = Vec3::Zero();  ///< of the point of the triangle, barycentric
  Real squared_distance = std::numeric_limits<Real>::infinity();  ///< m^2; 0 where they cross
};

/// The points of a segment and a triangle closest to each other. Where a segment lies in the plane
/// of the triangle, any such pair.
inline SegmentTriangle closest_points(const Segment& segment, const Corners& t) {
  SegmentTriangle best;
  const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
  const Real before = n.dot(segment.a - t[0]), behind = n.dot(segment.b - t[0]);
  if ((before < 0 && behind > 0) || (before > 0 && behind < 0)) {
    const Real s = before / (before - behind);
    const TrianglePoint foot = closest_point(segment.at(s), t);
    if (foot.edge < 0 && foot.corner < 0) return {s, foot.weights, 0};
  }
  const auto try_pair = [&](Real s, const Vec3& weights, Real distance) {
    if (distance < best.squared_distance) best = {s, weights, distance};
  };
  for (const Real s : {0., 1.}) {
    const TrianglePoint foot = closest_point(segment.at(s), t);
    try_pair(s, foot.weights, (segment.at(s) - foot.on(t)).squaredNorm());
  }
  for (Index e = 0; e < 3; ++e) {
    const std::size_t i = static_cast<std::size_t>(e), j = (i + 1) % 3;
    const SegmentPair pair = closest_points(segment, Segment{t[i], t[j]});
    Vec3 weights = Vec3::Zero();
    weights[e] = 1 - pair.t;
    weights[(e + 1) % 3] = pair.t;
    try_pair(pair.s, weights, pair.squared_distance);
  }
  return best;
}

}  // namespace sutura
