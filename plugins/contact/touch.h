// Where two partners touch, or may before the step ends.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "sutura/constraints.h"

namespace sutura::contact {

struct Touch {
  /// By which it is found again in the next pass and step: abscissae of the curves it is on, or
  /// numbers of nodes; -1, -2, ... for those of the second of two surfaces.
  Real first_place = 0, second_place = 0;
  Vec3 second_local = Vec3::Zero();  ///< of a tool: seen from its shape
  Index triangle = -1;               ///< of a surface
  Index node = -1;                   ///< of two surfaces: what meets the triangle; -1: an edge does
  Index node_triangle = -1;          ///< a corner of this one, or a point of its edge,
  Vec3 node_weights = Vec3::Zero();  ///< there, barycentric
  bool nodes_are_second = false;     ///< the triangle is one of the first
  Vec3 weights = Vec3::Zero();       ///< in the triangle, barycentric
  Vec3 normal = Vec3::UnitZ();       ///< unit, from the second to the first
  Vec3 along = Vec3::UnitX();        ///< roughly a direction on the surface, turning with the first
  Vec3 at = Vec3::Zero();            ///< where forces act, on both (m)
  Vec3 first_arm = Vec3::Zero();     ///< from the centre of the section to there (m)
  Vec3 second_arm = Vec3::Zero();    ///< likewise
  Real gap = 0;                      ///< between the surfaces; negative where they overlap (m)
  Real left = 0;                     ///< of an overlap at the start: what the step leaves of it (m)
  /// A strand that is bent round the other turns the normal as the other moves along it: by so much
  /// per length (1/m), and along which direction. Where it counts for nothing, 0.
  Real first_bend = 0, second_bend = 0;
  Vec3 first_tangent = Vec3::Zero(), second_tangent = Vec3::Zero();
  bool between_nodes = false;     ///< of a curve: where it is nearest, nearer than its nodes
  Real pressed = 0;               ///< normal force as the step begins (N)
  bool carries = false;           ///< force, at the end of the step
  Real slipped = 0;               ///< in the step, across the normal (m); infinite without friction
  Vec3 lambda = Vec3::Zero();     ///< what it carries, or carried when it was last seen (N)
  Mode mode = 0;                  ///< likewise
  std::uint64_t id = 0;           ///< of the contact, never used again
  Vec2 left_over = Vec2::Zero();  ///< what sticking has missed in the steps before (m)
};

/// Places on the first partner where there have been touches in this step or at the end of the one
/// before, ascending.
class TouchedPlaces {
 public:
  virtual ~TouchedPlaces() = default;
  /// The first of them after `low` and before `high`, or not a number.
  virtual Real between(Real low, Real high) const = 0;
};

/// For those who remember none.
class NoPlaces : public TouchedPlaces {
 public:
  Real between(Real, Real) const override { return std::numeric_limits<Real>::quiet_NaN(); }
};

/// Finds the touches of one pair of partners, and knows their rows.
class Pair {
 public:
  virtual ~Pair() = default;
  /// Before the first `find` of a step, or of a part of one: where it starts is new.
  void begin_step() { start_is_known_ = guess_is_kept_ = false; }
  /// At the present guess. Where the straight way to it is barred, from the start of the step and
  /// from the guess that is kept, `free_way` tells, and the touches are of no use.
  /// What was touched before is a touch again while it is near: touches do not come and go with
  /// the passes of a step.
  void find(const TouchedPlaces& before, std::vector<Touch>& out) {
    const std::size_t others = out.size();
    goes_on_ = false;
    look_for_touches(before, out);
    if (free_way_ == 1 || !guess_is_kept_ || !may_go_on()) return;
    out.resize(others);
    goes_on_ = true;
    look_for_touches(before, out);
  }
  /// The two have come to where they are now on a way that is free.
  void keep_guess() {
    if (knows_way_) guess_is_kept_ = keep() || guess_is_kept_;
  }
  /// A touch of these places of the two, which `find` has not found this time: `touch` as it is at
  /// the guess. False if they are no longer near each other, or if the pair does not know how.
  virtual bool find_again(Real /*first*/, Real /*second*/, Touch& /*touch*/) const { return false; }
  /// Of the last `find`: how much of that way is free.
  Real free_way() const { return free_way_; }
  /// Of the last `find`: false if that straight way may differ too much from where the two go, as
  /// one of them turns.
  bool knows_way() const { return knows_way_; }
  /// From which gap on a touch is built (m).
  virtual Real built_from(const Touch& touch) const = 0;
  /// How far the first has moved over the step relative to the second, at the touch (m).
  virtual Vec3 slip(const Touch& touch) const = 0;
  /// How far the surface of a thread has rolled over the step there (m).
  virtual Real rolled(const Touch& /*touch*/) const { return 0; }
  virtual void couple(const Touch& touch, BlockId block, const Directions& axes,
                      ConstraintBuilder& builder) const = 0;
  /// Row of how far one of the two shifts along the other: its centre along `direction`, as seen
  /// from the section of the other there. A rigid motion of both is no shift.
  virtual void couple_shift(const Touch& /*touch*/, bool /*of_first*/, BlockId /*block*/,
                            const Vec3& /*direction*/, ConstraintBuilder& /*builder*/) const {}
  /// After the step: the force on the first.
  virtual void tell_force(const Touch& /*touch*/, const Vec3& /*force*/) {}
  /// After the step: how deep the two overlap where no touch sees it (m).
  virtual Real unseen_overlap() { return 0; }
  /// Does `unseen_overlap` see what touches leave of an overlap as well? Then that alone is a
  /// fault.
  virtual bool sees_left_overlap() const { return false; }
  /// The smallest distance between the surfaces, now (m).
  virtual Real distance() const = 0;
  /// Do these places of the two belong to one rigid body now? Then there is no touch, and what it
  /// was stays as it was.
  virtual bool are_one(Real /*first*/, Real /*second*/) const { return false; }
  /// Two touches are one if their places differ by no more.
  struct Tolerance {
    Real first = 0, second = 0;
  };
  virtual Tolerance tolerance(const Touch& touch) const = 0;

 protected:
  virtual void look_for_touches(const TouchedPlaces& before, std::vector<Touch>& out) = 0;
  /// As a guess from which ways may go on. False if none may.
  virtual bool keep() { return false; }
  /// Of what is barred on the straight way: may guesses have led it round?
  virtual bool may_go_on() const { return false; }
  void begin_look() {
    free_way_ = 1;
    knows_way_ = true;
  }
  Real free_way_ = 1;
  bool knows_way_ = true;
  bool start_is_known_ = false;  ///< what a pair keeps of the start of the step holds
  bool goes_on_ = false;         ///< ways begin at the guess that is kept, not with the step

 private:
  bool guess_is_kept_ = false;
};

}  // namespace sutura::contact
