#include "closest_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sutura/geometry/distances.h"

namespace sutura::contact {
namespace {

/// How far the ends of the tangents stand off the chord: no point of the segment is further.
Real bow(const CurveSegment& s) {
  const Vec3 chord = s.xb - s.xa;
  const Real length = chord.norm();
  if (!(length > 0)) return s.ma.norm() / 3 + s.mb.norm() / 3;
  return std::max(chord.cross(s.ma).norm(), chord.cross(s.mb).norm()) / (3 * length);
}

/// Chords that the search begins from.
int chords(const CurveSegment& s, Real fine) {
  const Real off = bow(s);
  return off < 0.1 * fine ? 1 : off < 0.5 * fine ? 2 : 4;
}

void refine(const CurveSegment& a, const CurveSegment& b, bool u_is_fixed, ClosestPair& at) {
  at.apart = a.point(at.u) - b.point(at.v);
  Real here = at.apart.squaredNorm();
  for (int i = 0; i < 20; ++i) {
    const Vec3 ta = a.slope(at.u), tb = b.slope(at.v);
    const Real gu = at.apart.dot(ta), gv = -at.apart.dot(tb);
    // At an end of a segment the way may lead back only.
    const bool free_u = !u_is_fixed && !(at.u <= 0 && gu > 0) && !(at.u >= 1 && gu < 0);
    const bool free_v = !(at.v <= 0 && gv > 0) && !(at.v >= 1 && gv < 0);
    if (!free_u && !free_v) break;
    Real uu = ta.squaredNorm() + at.apart.dot(a.second(at.u));
    Real vv = tb.squaredNorm() - at.apart.dot(b.second(at.v));
    const Real uv = -ta.dot(tb);
    if (!(uu > 0.1 * ta.squaredNorm())) uu = ta.squaredNorm();
    if (!(vv > 0.1 * tb.squaredNorm())) vv = tb.squaredNorm();
    Real du = 0, dv = 0;
    const Real det = uu * vv - uv * uv;
    if (free_u && free_v && det > 1e-6 * uu * vv) {
      du = -(vv * gu - uv * gv) / det;
      dv = -(uu * gv - uv * gu) / det;
    } else if (free_u && (!free_v || std::abs(gu) * vv > std::abs(gv) * uu)) {
      du = -gu / uu;
    } else {
      dv = -gv / vv;
    }
    Real part = 1;
    ClosestPair next = at;
    for (int cut = 0; cut < 8; ++cut, part /= 2) {
      next.u = std::clamp(at.u + part * du, 0., 1.);
      next.v = std::clamp(at.v + part * dv, 0., 1.);
      next.apart = a.point(next.u) - b.point(next.v);
      if (next.apart.squaredNorm() <= here) break;
    }
    const Real there = next.apart.squaredNorm();
    if (!(there <= here)) break;
    const Real moved = std::abs(next.u - at.u) + std::abs(next.v - at.v);
    at = next;
    here = there;
    if (moved < 1e-12) break;
  }
  at.distance = std::sqrt(here);
}

}  // namespace

ClosestPair closest_on(const CurveSegment& a, const CurveSegment& b, Real fine) {
  const int na = chords(a, fine), nb = chords(b, fine);
  ClosestPair best;
  best.distance = std::numeric_limits<Real>::infinity();
  for (int i = 0; i < na; ++i) {
    const Segment p{a.point(Real(i) / na), a.point(Real(i + 1) / na)};
    for (int j = 0; j < nb; ++j) {
      const Segment q{b.point(Real(j) / nb), b.point(Real(j + 1) / nb)};
      const SegmentPair at = closest_points(p, q);
      const Real distance = std::sqrt(at.squared_distance);
      if (distance < best.distance)
        best = {(i + at.s) / na, (j + at.t) / nb, distance, Vec3::Zero()};
    }
  }
  refine(a, b, false, best);
  return best;
}

ClosestPair closest_to(const Vec3& p, Real u, const CurveSegment& b) {
  CurveSegment point;
  point.xa = point.xb = p;
  point.ma = point.mb = Vec3::Zero();
  ClosestPair best;
  best.distance = std::numeric_limits<Real>::infinity();
  constexpr int parts = 2;
  for (int j = 0; j < parts; ++j) {
    const Segment q{b.point(Real(j) / parts), b.point(Real(j + 1) / parts)};
    const Real t = closest_point(p, q), distance = (q.at(t) - p).norm();
    if (distance < best.distance) best = {u, (j + t) / parts, distance, Vec3::Zero()};
  }
  refine(point, b, true, best);
  best.u = u;
  return best;
}

}  // namespace sutura::contact
