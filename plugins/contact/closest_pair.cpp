#include "closest_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

// Ericson, Real-Time Collision Detection, 2005, section 5.1.9: one parameter free, then clamped.
ClosestPair closest_on_chords(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 p = b - a, q = d - c, r = a - c;
  const Real pp = p.squaredNorm(), qq = q.squaredNorm(), pq = p.dot(q);
  const Real pr = p.dot(r), qr = q.dot(r);
  const Real det = pp * qq - pq * pq;
  ClosestPair at;
  at.u = det > 1e-12 * pp * qq ? std::clamp((pq * qr - pr * qq) / det, 0., 1.) : 0.5;
  at.v = qq > 0 ? (pq * at.u + qr) / qq : 0;
  if (at.v < 0 || at.v > 1) {
    at.v = std::clamp(at.v, 0., 1.);
    at.u = pp > 0 ? std::clamp((pq * at.v - pr) / pp, 0., 1.) : 0;
  }
  at.apart = r + at.u * p - at.v * q;
  at.distance = at.apart.norm();
  return at;
}

ClosestPair closest_on(const CurveSegment& a, const CurveSegment& b, Real fine) {
  const int na = chords(a, fine), nb = chords(b, fine);
  ClosestPair best;
  best.distance = std::numeric_limits<Real>::infinity();
  for (int i = 0; i < na; ++i) {
    const Vec3 a0 = a.point(Real(i) / na), a1 = a.point(Real(i + 1) / na);
    for (int j = 0; j < nb; ++j) {
      ClosestPair at =
          closest_on_chords(a0, a1, b.point(Real(j) / nb), b.point(Real(j + 1) / nb));
      if (!(at.distance < best.distance)) continue;
      at.u = (i + at.u) / na, at.v = (j + at.v) / nb;
      best = at;
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
    const Vec3 c = b.point(Real(j) / parts), q = b.point(Real(j + 1) / parts) - c;
    const Real v = q.squaredNorm() > 0 ? std::clamp(q.dot(p - c) / q.squaredNorm(), 0., 1.) : 0;
    const Real distance = (p - c - v * q).norm();
    if (distance < best.distance) best = {u, (j + v) / parts, distance, p - c - v * q};
  }
  refine(point, b, true, best);
  best.u = u;
  return best;
}

}  // namespace sutura::contact
