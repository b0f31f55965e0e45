// How the sections of a chain turn, and how a chain goes from one place to another by a motion of
// its nodes (m, rad; 6 per node).
#pragma once

#include <vector>

#include "dof_vector.h"
#include "element.h"

namespace sutura::thread {

/// exp(spin) applied to q.
Quat rotated(const Quat& q, const Vec3& spin);
/// A section that first rolls about its tangent (x axis) by the part of `turn` along it, then tilts
/// by the part across it (rad). Unlike a rotation vector, roll and tilt do not mix, whatever the
/// number of turns that the section rolls.
Quat turned(const Quat& q, const Vec3& turn);
/// By how much the turn of a section (see `turned`) changes when it spins a little further: the
/// inverse of the derivative of its rotation. `from`, `to`: its tangents at the start and now.
Vec3 as_change_of_turn(const Vec3& turn, const Vec3& from, const Vec3& to, const Vec3& spin);
inline Vec3 tangent(const Pose& section) {
  return section.rotation * Vec3::UnitX();
}
/// The rotation vector (norm at most pi) that takes `from` to `to`, in world axes.
Vec3 rotation_between(const Quat& from, const Quat& to);

/// Shifts and turns every node of a chain; `twist` of the beams (rad) goes on by what their ends
/// turn against each other. `to` may be `from`.
void move_chain(const std::vector<Pose>& from, const std::vector<Real>& twist_from,
                const Dofs& motion, std::vector<Pose>& to, std::vector<Real>& twist_to);

/// What a motion of the nodes does to one beam: shift of its end b less that of a, spin of a, spin
/// of b (the variables of element.h).
inline Vec9 beam_motion(const Dofs& motion, Index beam) {
  const auto of = motion.segment<12>(6 * beam);
  return (Vec9() << of.segment<3>(6) - of.segment<3>(0), of.segment<3>(3), of.segment<3>(9))
      .finished();
}

/// rad: inside it the quadratic model of a beam is good.
inline constexpr Real turn_limit = 0.5;

}  // namespace sutura::thread
