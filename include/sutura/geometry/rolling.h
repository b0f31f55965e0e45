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

/// A roll, many turns perhaps, as what two rotations tell of it and whole turns besides (rad).
struct Roll {
  Real told, whole;
  Real sum() const { return told + whole; }
};

/// The one that ends as `told` and is about so much (rad).
inline Roll roll_like(Real told, Real about) {
  constexpr Real turn = 2 * std::numbers::pi;
  return {told, turn * std::round((about - told) / turn)};
}

/// By how much section s, with these rotations as the step began and at the guess, has rolled over
/// the step: what is left of its turn where its tangent has gone the shortest way.
inline Roll roll(const SegmentedCurve& curve, Real s, const Quat& was, const Quat& is) {
  return roll_like(roll_between(was, is), curve.coarse_roll(s));
}

/// Likewise against something rigid: had it stayed on that, its rotation would be `carried`.
inline Roll roll_against(const SegmentedCurve& curve, Real s, const Quat& was, const Quat& is,
                         const Quat& carried) {
  const Real about = roll(curve, s, was, is).sum() - roll_between(was, carried);
  return roll_like(roll_between(carried, is), about);
}

}  // namespace sutura
