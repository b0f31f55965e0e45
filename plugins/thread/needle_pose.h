// Where a needle is, in the words of who places it: tip and direction, centre of the arc and angle
// of the tip, or the point where it is to enter.
#pragma once

#include <string>

#include "sutura/types.h"

namespace sutura::thread {

struct NeedleArc {
  Real length = 0;              ///< m
  Real angle = 0;               ///< rad; 0: straight
  Vec3 normal = Vec3::UnitZ();  ///< turning right-handed about it advances the tip
  Real radius() const { return length / angle; }  ///< m
};

/// The tip, and where it points.
struct TipPlace {
  Vec3 tip = Vec3::Zero();
  Vec3 direction = Vec3::UnitX();
  std::string error;  ///< why there is none, in a sentence; or empty
};

/// By the centre of the arc and the angle of the tip on it, counted in the sense in which the
/// needle advances, from the lowest point (towards -z).
TipPlace place_by_centre(const NeedleArc& arc, const Vec3& centre, Real tip_angle);
/// So that the tip, after advancing by `approach` (m) along the arc, is at `entry` and points along
/// `direction`.
TipPlace place_by_entry(const NeedleArc& arc, const Vec3& entry, const Vec3& direction,
                        Real approach);

}  // namespace sutura::thread
