// A curve on its way through a step: every point goes straight from where it was, as the step began
// or at a guess that was kept, to where the guess has it.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sutura/geometry/box_tree.h"
#include "sutura/geometry/curve_segments.h"
#include "sutura/geometry/poses.h"
#include "sutura/geometry/rolling.h"

namespace sutura::contact {

inline CurveSegment on_the_way(const CurveSegment& a, const CurveSegment& b, Real time) {
  CurveSegment s = b;
  const auto mix = [time](const Vec3& x, const Vec3& y) { return Vec3(x + time * (y - x)); };
  s.xa = mix(a.xa, b.xa), s.ma = mix(a.ma, b.ma);
  s.xb = mix(a.xb, b.xb), s.mb = mix(a.mb, b.mb);
  return s;
}

inline CurveSegment seen_from(const Pose& frame, const CurveSegment& s) {
  const Quat back = frame.rotation.conjugate();
  CurveSegment out = s;
  out.xa = back * (s.xa - frame.position), out.xb = back * (s.xb - frame.position);
  out.ma = back * s.ma, out.mb = back * s.mb;
  return out;
}

struct MovingCurve {
  std::vector<CurveSegment> start, guess, now;
  bool goes_on = false;  ///< its way begins at the guess

  /// The start of a step is where it was in all of its passes.
  void look(const SegmentedCurve& curve, bool start_is_known, bool from_guess = false) {
    if (!start_is_known) curve.segments(Configuration::start, start);
    curve.segments(Configuration::current, now);
    goes_on = from_guess;
  }
  void keep(const SegmentedCurve& curve) { curve.segments(Configuration::current, guess); }
  /// Where the way of segment i begins.
  const CurveSegment& from(std::size_t i) const { return goes_on ? guess[i] : start[i]; }
  std::size_t size() const { return now.size(); }
  /// Is segment i the first, or the last, of its piece?
  bool begins_piece(std::size_t i) const { return i == 0 || now[i - 1].cut; }
  bool ends_piece(std::size_t i) const { return i + 1 == size() || now[i + 1].cut; }
  /// Likewise, or does the curve go on thinner there, as behind a needle?
  bool begins_thick(std::size_t i) const {
    return begins_piece(i) || now[i - 1].radius < now[i].radius;
  }
  bool ends_thick(std::size_t i) const {
    return ends_piece(i) || now[i + 1].radius < now[i].radius;
  }
  /// Of two segments that share a node one has it: the thicker, else the second. Is this the one,
  /// with its node at u = 0 or 1?
  bool has_node(std::size_t i, Real u) const {
    return u < 1 ? begins_piece(i) || !ends_thick(i - 1) : ends_thick(i);
  }
  CurveSegment at(std::size_t i, Real time) const { return on_the_way(from(i), now[i], time); }
  /// Points whose convex hull contains a segment.
  static void hull(const CurveSegment& s, Vec3 (&points)[4]) {
    points[0] = s.xa, points[1] = s.xa + s.ma / 3, points[2] = s.xb - s.mb / 3, points[3] = s.xb;
  }
  /// Now: the segment at this abscissa.
  std::size_t index_at(Real s) const {
    const auto it = std::lower_bound(now.begin(), now.end() - 1, s,
                                     [](const CurveSegment& g, Real at) { return g.to < at; });
    return static_cast<std::size_t>(it - now.begin());
  }
  const CurveSegment& segment_at(Real s) const { return now[index_at(s)]; }
  static void add_to(Box& box, const CurveSegment& s) {
    Vec3 points[4];
    hull(s, points);
    for (const Vec3& p : points) box.add(p);
  }
  /// No point of segment i moves further, less a `common` motion (m).
  Real motion(std::size_t i, const Vec3& common = Vec3::Zero()) const {
    Vec3 was[4], is[4];
    hull(from(i), was), hull(now[i], is);
    Real most = 0;
    for (int k = 0; k < 4; ++k) most = std::max(most, (is[k] - was[k] - common).squaredNorm());
    return std::sqrt(most);
  }
  /// No point of segment i is further from the middle of its chord (m).
  static Real extent(const CurveSegment& s) {
    Vec3 points[4];
    hull(s, points);
    const Vec3 middle = (s.xa + s.xb) / 2;
    Real most = 0;
    for (const Vec3& p : points) most = std::max(most, (p - middle).squaredNorm());
    return std::sqrt(most);
  }
};

/// A section of a curve at both ends of the step.
struct SectionMotion {
  Pose was, is;

  SectionMotion(const SegmentedCurve& curve, Real s)
      : was(curve.frame(s, Configuration::start)), is(curve.frame(s, Configuration::current)) {}
};

/// How far the surface has gone over the step at the touch that is now away from the section at s
/// by `arm`, seen from a rigid partner that has gone from one pose to another (m). What the section
/// has rolled on it counts as a length, roll times arm, however many turns it is; the way of one
/// point of the surface is its sine.
inline Vec3 moved_on(const Pose& partner_was, const Pose& partner_is, const SegmentedCurve& curve,
                     Real s, const SectionMotion& section, const Vec3& arm) {
  const Pose &was = section.was, &is = section.is;
  const Quat turn = partner_is.rotation * partner_was.rotation.conjugate();
  const Pose carried{partner_is.position + turn * (was.position - partner_was.position),
                     turn * was.rotation};
  const Vec3 along = is.rotation * Vec3::UnitX();
  const Vec3 arm_was = shortest_rotation(along, carried.rotation * Vec3::UnitX()) * arm;
  const Real roll = roll_against(curve, s, was.rotation, is.rotation, carried.rotation).sum();
  return is.position - carried.position + arm - arm_was + roll * along.cross(arm);
}

inline Vec3 moved_on(const Pose& partner_was, const Pose& partner_is, const SegmentedCurve& curve,
                     Real s, const Vec3& arm) {
  return moved_on(partner_was, partner_is, curve, s, SectionMotion(curve, s), arm);
}

/// How far the surface of the section has rolled, seen from such a partner (m).
inline Real rolled_on(const Pose& partner_was, const Pose& partner_is, const SegmentedCurve& curve,
                      Real s, const Vec3& arm) {
  const SectionMotion section(curve, s);
  return (moved_on(partner_was, partner_is, curve, s, section, arm) -
          moved_on(partner_was, partner_is, curve, s, section, Vec3::Zero()))
      .norm();
}

/// The lowest height over a plane that any point of the segment has on its way.
inline Real lowest_on_the_way(const CurveSegment& start, const CurveSegment& now,
                              const Vec3& normal) {
  Vec3 from[4], to[4];
  MovingCurve::hull(start, from), MovingCurve::hull(now, to);
  Real lowest = normal.dot(from[0]);
  for (int k = 0; k < 4; ++k) lowest = std::min({lowest, normal.dot(from[k]), normal.dot(to[k])});
  return lowest;
}

/// How much of the way from time 0 to 1 is free: `distance(time)` stays above `clearance` on it. No
/// point moves more than `motion` against the other side on the whole way, and between two looks
/// the distance cannot fall below half the clearance: a step is never longer than that takes. Of a
/// guess that has gone astray, by metres or to where nothing is a number, as much as is known to be
/// free after a number of looks.
template <class Distance>
Real way_through(Real motion, Real clearance, const Distance& distance) {
  constexpr int most_looks = 1000;
  if (!std::isfinite(motion)) return 0;
  Real free = 0, time = 0;
  for (int look = 0; look < most_looks; ++look) {
    const Real d = distance(time);
    if (!(d >= clearance)) {
      // As near as it may come: there is a touch.
      for (int k = 0; k < 10; ++k) {
        const Real middle = (free + time) / 2;
        (distance(middle) >= clearance ? free : time) = middle;
      }
      return free;
    }
    if (time >= 1) return 1;
    free = time;
    const Real room = d - clearance / 2;
    time = motion * (1 - time) <= room ? Real(1) : time + room / motion;
  }
  return free;
}

}  // namespace sutura::contact
