// Where two partners touch, or may before the step ends.
#pragma once

#include <cstdint>
#include <vector>

#include "sutura/constraints.h"

namespace sutura::contact {

struct Touch {
  /// By which it is found again in the next pass and step: abscissae of the curves it is on, or
  /// numbers of nodes.
  Real first_place = 0, second_place = 0;
  EmbeddedPoint first, second;     ///< in the material; of a tool, `second_local` instead
  Vec3 second_local = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();     ///< unit, from the second to the first
  Vec3 along = Vec3::UnitX();      ///< roughly a direction on the surface, turning with the first
  Vec3 at = Vec3::Zero();          ///< where forces act, on both (m)
  Vec3 first_arm = Vec3::Zero();   ///< from the centre of the section to there (m)
  Vec3 second_arm = Vec3::Zero();  ///< likewise
  Real gap = 0;                    ///< between the surfaces; negative where they overlap (m)
  bool crossed = false;            ///< the way of the guess leads through: it must not stand
  bool carries = false;            ///< force, at the end of the step
  std::uint64_t id = 0;            ///< of the contact, never used again
  Vec2 left_over = Vec2::Zero();   ///< what sticking has missed in the steps before (m)
};

/// Places on the first partner where there have been touches in this step or at the end of the one
/// before, ascending.
class TouchedPlaces {
 public:
  virtual ~TouchedPlaces() = default;
  /// The first of them after `low` and before `high`, or not a number.
  virtual Real between(Real low, Real high) const = 0;
};

/// Finds the touches of one pair of partners, and knows their rows.
class Pair {
 public:
  virtual ~Pair() = default;
  /// At the present guess, with all that the way from the start of the step to it leads through.
  /// What was touched before is a touch again while it is near: touches do not come and go with
  /// the passes of a step.
  virtual void find(const TouchedPlaces& before, std::vector<Touch>& out) = 0;
  /// How far the first has moved over the step relative to the second, at the touch (m).
  virtual Vec3 slip(const Touch& touch) const = 0;
  virtual void couple(const Touch& touch, BlockId block, const Directions& axes,
                      ConstraintBuilder& builder) const = 0;
  /// After the step: the force on the first.
  virtual void tell_force(const Touch& /*touch*/, const Vec3& /*force*/) {}
  /// The smallest distance between the surfaces, now (m).
  virtual Real distance() const = 0;
  /// Two touches are one if their places differ by no more.
  struct Tolerance {
    Real first = 0, second = 0;
  };
  virtual Tolerance tolerance(const Touch& touch) const = 0;
};

}  // namespace sutura::contact
