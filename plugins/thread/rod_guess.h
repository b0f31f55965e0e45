// What a step of a rod begins from, and a guess of its end: where that is, and what it lacks of
// balance.
//
// The balance, with poses x = start + h v and v the velocity at the end (6 per node: translation,
// spin; world axes):
//   r = M (v_start - v) + h (f(x) + weight - B v),      B = alpha M + beta K
// f is the exact gradient of the energy; B v is the drag alpha M v and the viscous force of
// viscosity.h. r plus h times the forces of constraints is zero at the end of a step.
#pragma once

#include <vector>

#include "rod_history.h"

namespace sutura::thread {

struct RodDamping {
  Real mass = 0;       ///< alpha, 1/s
  Real stiffness = 0;  ///< beta, s
};

/// What a step begins from, and what goes on all the time. The poses of the start are the rod's
/// (Configuration::start). A step that looks two steps back has a moment and a length of its own
/// making (rod_history.h).
struct RodStart : RodMoment {
  Real dt = 0;
  Vec3 gravity = Vec3::Zero();
  RodDamping damping;
  DofVector load;           ///< dead loads, N, N m; 6 per node
  std::vector<Real> twist;  ///< per beam, rad
  RodMotion carried;        ///< what of the motion from the start is no velocity: 0, or c u_before

  void resize(Index nodes);
  void reserve(Index nodes);
};

/// The forces of constraints on the nodes, as they act while a rod goes from one guess to the next:
/// a force beside a node has a moment there, t x lever, that turns with the tangent t.
struct ConstraintForce {
  DofVector at;                    ///< N, N m; 6 per node
  std::vector<Vec3> lever;         ///< per node, N m
  std::vector<Real> axial_moment;  ///< per node, about the tangent, N m

  void resize(Index nodes);
  void reserve(Index nodes);
  bool pushes(Index node) const { return !at.segment<3>(6 * node).isZero(0); }
  /// Force times its distance from the node, as far as its moment tells: across the tangent (N m).
  Vec3 lever_at(Index node, const Pose& section) const;
  /// Lever and axial moment of every node from `at`, at the present poses.
  void hold(const Rod& rod);
  /// Work on a node since the start of the step (J).
  Real work(const Rod& rod, Index node, const Dofs& motion) const;
};

/// So little strain is rounding.
constexpr Real strain_rounding = 1e-10;

/// The sum of the sizes of what acts on a node, on its own and through its beams.
struct AtWork {
  Real force = 0;    ///< N
  Real bending = 0;  ///< moments across the tangent, N m
  Real roll = 0;     ///< moments about the tangent, N m

  void add_moment(const Vec3& moment, const Vec3& tangent);
  AtWork& operator+=(const AtWork& other);
};

/// A guess of the end of a step. Its unknowns are the motion, the forces of constraints and the
/// tension of the beams; the rod's poses, twist and velocity are those of the motion.
struct RodGuess {
  DofVector motion;  ///< from the start: shift and turn of every node (see `turned`; m, rad)
  ConstraintForce force;
  std::vector<Real> tension;  ///< per beam, that the pass before predicted, N
  /// Per beam, that an Elongation is known to bear beside it (N): it turns with the beam.
  std::vector<Real> limit_tension;

  Real chord_roll = 1;  ///< of the convex stiffness here (`step_stiffness` in element.h)

  // What `move` and `evaluate` find there.
  std::vector<ElementState> beams;
  DofVector missing;  ///< r: momentum due without forces of constraints (N s, N m s; 6 per node)
  std::vector<AtWork> at_work;  ///< per node, without the forces of constraints

  void resize(Index nodes);
  void reserve(Index nodes);
  /// Puts the rod where the motion leads, with the velocity that takes it there, and evaluates.
  void move(Rod& rod, const RodStart& start);
  /// The tension is that of the beams as they are.
  void take_tension();
  /// Force and moment of the spring on the section that it holds.
  Wrench wrench(const Rod& rod, const NodeSpring& spring) const {
    return spring.wrench(rod.poses()[spring.node], roll(rod, spring));
  }
  Real roll(const Rod& rod, const NodeSpring& spring) const;
  /// Where it is held or pushed; of a rigid stretch, the leader says so for all.
  bool goes_straight(const Rod& rod, Index node) const;

 private:
  void evaluate(Rod& rod, const RodStart& start);
  void add_beam(const Rod& rod, const RodStart& start, Index beam);
  void gather(const Rod& rod);
};

/// How a beam is deformed against the start of the step.
inline DeformationChange change_of_deformation(const Rod& rod, const RodStart& start,
                                               const RodGuess& guess, Index beam) {
  return {guess.beams[beam], rod.poses()[beam], rod.poses()[beam + 1], start.deformation[beam]};
}

}  // namespace sutura::thread
