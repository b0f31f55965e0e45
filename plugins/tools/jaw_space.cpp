#include "jaw_space.h"

#include <algorithm>
#include <cmath>

#include "sutura/geometry/box_tree.h"

namespace sutura::tools {
namespace {

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

}  // namespace

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
