#include "jaw_space.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sutura/geometry/box_tree.h"

namespace sutura::tools {
namespace {

// Strands stop when they are so far apart, as a part of the distance at which they touch: a line of
// points is not quite where the curve is, and hard jaws make a force of a micron.
constexpr Real apart = 1.01;

/// A corner of a polygon in a triangle: where it is, and its weights there.
struct Corner {
  Vec3 at, weights;
};

/// Cuts a convex polygon: what stays has sign * at[axis] <= limit.
struct Polygon {
  static constexpr int most = 9;  // three corners, and one more for each of six planes
  std::array<Corner, most> corners;
  int count = 0;

  void add(const Corner& c) {
    if (count < most) corners[static_cast<std::size_t>(count++)] = c;
  }
  Polygon cut(int axis, Real sign, Real limit) const {
    Polygon out;
    for (int i = 0; i < count; ++i) {
      const Corner& a = corners[static_cast<std::size_t>(i)];
      const Corner& b = corners[static_cast<std::size_t>((i + 1) % count)];
      const Real beyond_a = sign * a.at[axis] - limit, beyond_b = sign * b.at[axis] - limit;
      if (beyond_a <= 0) out.add(a);
      if ((beyond_a < 0 && beyond_b > 0) || (beyond_a > 0 && beyond_b < 0)) {
        const Real u = beyond_a / (beyond_a - beyond_b);
        out.add({a.at + u * (b.at - a.at), a.weights + u * (b.weights - a.weights)});
      }
    }
    return out;
  }
};

/// Whether two links of the lines are neighbours, which do not count as touching. Links of one
/// strand are, unless it turns back between them: one that only lies askew may be pressed flat.
bool are_neighbours(const Strand& a, std::size_t i, const Strand& b, std::size_t j) {
  if (a.curve != b.curve) return false;
  const auto middle = [](const Strand& s, std::size_t k) {
    return s.low + (Real(k) + 0.5) / Real(s.line.size() - 1) * (s.high - s.low);
  };
  if (std::abs(middle(a, i) - middle(b, j)) < std::numbers::pi * a.radius) return true;
  return &a == &b && (a.line[i + 1] - a.line[i]).dot(a.line[j + 1] - a.line[j]) >= 0;
}

/// With the heights of all strands times `flat`.
bool touch(const Strand& a, const Strand& b, Real flat) {
  const Vec3 press(1, 1, flat);
  const auto link = [&](const Strand& s, std::size_t i) {
    return Segment{press.cwiseProduct(s.line[i]), press.cwiseProduct(s.line[i + 1])};
  };
  const Real least = apart * (a.radius + b.radius);
  for (std::size_t i = 0; i + 1 < a.line.size(); ++i)
    for (std::size_t j = &a == &b ? i : 0; j + 1 < b.line.size(); ++j)
      if (!are_neighbours(a, i, b, j) &&
          closest_points(link(a, i), link(b, j)).squared_distance < least * least)
        return true;
  return false;
}

}  // namespace

Real flattest(const std::vector<Strand>& strands) {
  Real flat = 0;
  for (std::size_t i = 0; i < strands.size(); ++i)
    for (std::size_t j = i; j < strands.size(); ++j) {
      // Pressed flatter, points only come nearer: the flattest is found by halving.
      if (!touch(strands[i], strands[j], flat)) continue;
      Real high = 1;
      for (int k = 0; k < 30; ++k) {
        const Real middle = (flat + high) / 2;
        (touch(strands[i], strands[j], middle) ? flat : high) = middle;
      }
      flat = high;
    }
  return flat;
}

void JawSpace::stretches(const std::vector<CurveSegment>& curve, std::vector<Stretch>& out) const {
  out.clear();
  bool inside = false;
  const Box space{-half, half};
  const auto crossing = [&](const CurveSegment& s, Real from, Real to) {
    const bool begin = contains(s.point(from));
    for (int k = 0; k < 40; ++k) {
      const Real u = (from + to) / 2;
      (contains(s.point(u)) == begin ? from : to) = u;
    }
    return (from + to) / 2;
  };
  for (const CurveSegment& s : curve) {
    Box box;
    const Vec3 hull[] = {s.xa, s.xa + s.ma / 3, s.xb - s.mb / 3, s.xb};
    Real length = 0;
    for (int k = 0; k < 4; ++k) {
      box.add(hull[k]);
      if (k > 0) length += (hull[k] - hull[k - 1]).norm();
    }
    if (!box.meets(space)) {
      inside = false;
      continue;
    }
    const int parts = static_cast<int>(std::clamp(std::ceil(length / half.minCoeff()), 2., 1e4));
    for (int k = 0; k <= parts; ++k) {
      const Real u = Real(k) / parts;
      const bool now = contains(s.point(u));
      if (now && !inside)
        out.push_back({.low = s.abscissa(k > 0 ? crossing(s, Real(k - 1) / parts, u) : u)});
      if (inside && !now && k > 0)
        out.back().high = s.abscissa(crossing(s, Real(k - 1) / parts, u));
      if (now) out.back().high = s.abscissa(u);
      inside = now;
    }
  }
  for (Stretch& stretch : out) {
    const Real at = (stretch.low + stretch.high) / 2;
    for (const CurveSegment& s : curve)
      if (at >= s.from && at <= s.to) stretch.middle = s.point((at - s.from) / s.length());
  }
}

JawSpace::Part JawSpace::part(const Corners& triangle) const {
  Polygon p;
  for (std::size_t k = 0; k < 3; ++k) p.add({triangle[k], Vec3::Unit(static_cast<Index>(k))});
  for (int axis = 0; axis < 3; ++axis)
    for (const Real sign : {-1., 1.}) p = p.cut(axis, sign, half[axis]);
  Part out;
  for (int k = 2; k < p.count; ++k) {
    const Corner &a = p.corners[0], &b = p.corners[static_cast<std::size_t>(k - 1)],
                 &c = p.corners[static_cast<std::size_t>(k)];
    const Real area = (b.at - a.at).cross(c.at - a.at).norm() / 2;
    out.area += area;
    out.weights += area / 3 * (a.weights + b.weights + c.weights);
  }
  if (out.area > 0) out.weights /= out.area;
  return out;
}

}  // namespace sutura::tools
