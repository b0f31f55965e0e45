// What turns within a step goes along an arc, while its way is taken to be straight: how far the
// two may be from each other.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rigid_tool.h"
#include "sutura/geometry/curve_segments.h"
#include "sutura/geometry/distances.h"

namespace sutura::contact {

/// Height of an arc over its chord (m), along which the direction turns by so much (rad). Of one
/// that turns by half a turn or more, that of a half circle.
inline Real arc_height(Real chord, Real turn) {
  return chord / 2 * std::tan(std::min(turn, Real(std::numbers::pi)) / 4);
}

inline Real angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The angle by which a beam of a needle turns in a step: that of its tangents, whatever it rolls.
/// A needle goes along an arc then. What is soft goes nobody knows how: 0 of a thread.
inline Real turn_of_needle(const CurveBody& of, const CurveSegment& was, const CurveSegment& is) {
  if (is.from >= of.needle_length()) return 0;
  return std::max(angle_between(was.ma, is.ma), angle_between(was.mb, is.mb));
}

/// A rigid tool on its way through a step.
class ToolWay {
 public:
  /// `goes_on`: what is looked at begins its way where the tool has come to the end of its own.
  void look(const RigidTool& tool, bool goes_on);
  /// How far a beam, or a triangle, may be from its straight way seen from the tool (m). Where it
  /// was and where it is, seen from there.
  Real bulge(const CurveBody& of, const CurveSegment& was, const CurveSegment& is) const;
  Real bulge(const Corners& was, const Corners& is) const;

 private:
  Real bulge(const Vec3& was, const Vec3& is, Real turn) const;
  Pose start_, half_way_, end_;
  Real turn_ = 0;  ///< rad
  bool is_still_ = true;
};

}  // namespace sutura::contact
