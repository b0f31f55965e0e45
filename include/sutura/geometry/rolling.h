// How far the sections of a curve roll about their tangent.
#pragma once

#include <cmath>
#include <numbers>

#include "sutura/geometry/curve_segments.h"

namespace sutura {

/// By how much `to` is rolled about its x axis when that has gone there from `from` the shortest
/// way (rad, at most pi).
inline Real roll_between(const Quat& from, const Quat& to) {
  const Quat tilted = shortest_rotation(from * Vec3::UnitX(), to * Vec3::UnitX()) * from;
  const Quat left = tilted.conjugate() * to;
  return 2 * std::atan2(left.w() < 0 ? -left.x() : left.x(), std::abs(left.w()));
}

/// The whole turns (in rad) by which section s has rolled over the step against something rigid,
/// beyond what the two rotations tell. `was` and `is` are its rotations at both ends of the step,
/// `carried` what it would be now, had it stayed on that.
inline Real whole_rolls(const SegmentedCurve& curve, Real s, const Quat& was, const Quat& is,
                        const Quat& carried) {
  constexpr Real whole = 2 * std::numbers::pi;
  const Real about = curve.roll(s) - roll_between(was, carried);
  return whole * std::round((about - roll_between(carried, is)) / whole);
}

}  // namespace sutura
