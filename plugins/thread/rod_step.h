// One step of a rod by implicit Euler or, where it looks back two steps, by BDF2 (rod_history.h),
// solved in passes. The passes are the caller's (step.cpp of the runtime).
//
// A guess of the end of the step (rod_guess.h) lacks the momentum r. A pass solves A dv = r
// (rod_tangent.h) and goes on by the answer (rod_way.h), as far as the potential falls
// (rod_potential.h). A has the exact Hessian where that leaves it positive definite, and its convex
// part elsewhere. All the time the rod is where the guess has it; `end` leaves it there.
#pragma once

#include "block_tridiagonal.h"
#include "dead_moment.h"
#include "rod_guess.h"
#include "rod_tangent.h"
#include "rod_way.h"

namespace sutura::thread {

class RodStep {
 public:
  RodDamping damping;

  RodStep() = default;
  explicit RodStep(const Rod& rod) { fit(rod); }
  /// To be called whenever the rod was built, has got other nodes or other rigid stretches. What
  /// acts on it is zero then.
  void fit(const Rod& rod);
  /// Room for so many beams: up to it, no call allocates anything.
  void reserve(Index beams);
  /// What the next step asks of the last one, between two steps.
  void archive(Archive& archive, const Rod& rod);

  /// Dead loads of the steps to come (N, N m; 6 per node), or empty: none.
  void set_load(const VecX& load);
  /// At the present guess, of a beam: what an Elongation bears there (N).
  void set_limit_tension(Index beam, Real tension) { guess_.limit_tension[beam] = tension; }
  /// Begins a step where the last one ended, or the same step anew with another length or order.
  /// Of `order` 2 it looks back two steps, if the last one was begun so and is not too short.
  /// The first guess goes on as before or, where that is better, with the rod as a whole alone.
  void begin(Rod& rod, Real dt, const Vec3& gravity, Index order = 1);
  /// Assembles and factors A at the guess and finds the change under `force` of constraints. False
  /// if A is not positive definite.
  bool linearise(const Rod& rod, const Dofs& force);
  /// Columns of forces (dofs x any) become A^-1 of them, with the A of the last pass.
  void answer(const Rod& rod, Eigen::Ref<MatX> columns) const;
  /// A change of the force of constraints: its answer is added to `change`.
  void push(const Rod& rod, const Dofs& force_change);
  /// The guess moves by that change; only part of the way where it turns a beam too far.
  void correct(Rod& rod);
  bool went_part_way() const { return part_way_; }
  /// Of the guess under `force` of constraints.
  Imbalance imbalance(const Rod& rod, const Dofs& force) const;
  /// h/2 times the change of velocity, the largest over the nodes that nothing holds (m); two steps
  /// back, what BDF2 leaves out of the motion in a step.
  Real time_error(const Rod& rod) const;
  /// Two steps back: whether velocities have changed about as they did in the step before. If not
  /// (a hand has let go, a load has begun), what they did then does not tell how they go on.
  bool goes_on_as_before(const Rod& rod);
  /// A balanced guess that is no minimum of the potential, with what constraints push held where it
  /// is, moves on to where that is lower. False if it is a minimum.
  bool leave_saddle(Rod& rod);
  /// The guess is at a saddle, and no lower potential was found beside it.
  bool is_stuck() const { return stuck_; }
  /// Another guess.
  void move_to(Rod& rod, const VecX& motion);
  bool in_step() const { return in_step_; }
  /// Within a step: the rod is as it was when that began, and the step is not begun any more.
  void go_back(Rod& rod);
  /// The guess is the end of the step, which had this force of constraints.
  void end(Rod& rod, const Dofs& force);
  /// A whole step under `force` alone, in passes until its relative imbalance is below `tolerance`.
  /// Returns the passes, 0 if they did not get there.
  Index advance(Rod& rod, Real dt, const Vec3& gravity, const Dofs& force, Real tolerance = 1e-9);

  /// Tension of the beam by its viscosity at the end of the last step (N).
  Real viscous_tension(Index beam) const {
    return viscous_tension_[static_cast<std::size_t>(beam)];
  }
  const RodStart& start() const { return start_; }
  const RodGuess& guess() const { return guess_; }
  /// Change of the guess, in velocity, that answers what is missing of balance.
  const DofVector& change() const { return change_; }
  /// A, as the last pass has factored it.
  const BlockTridiagonal& matrix() const { return matrix_; }

 private:
  void set_start(Real dt);
  void stay(Rod& rod);
  bool goes_uphill(Real lacks, const Rod& rod);
  Real imbalance_of_whole(const Rod& rod, const Dofs& force, Real everywhere) const;
  Real imbalance_of_roll(const Rod& rod, const Dofs& force) const;
  bool is_compressed(const Rod& rod) const;
  void assemble_unpushed(const Rod& rod, Real convex);
  bool buckles(const Rod& rod);
  Real find_buckling(const Rod& rod);
  bool buckle(Rod& rod);
  void descend(Rod& rod);

  RodStart start_;
  RodMoment now_;      ///< as the step begins
  RodHistory before_;  ///< of the last step, if that was begun with order 2
  Real length_ = 0;    ///< of the step (s)
  Index order_ = 1;    ///< that was asked for
  Real share_ = 0;     ///< c; 0: one step back
  RodGuess guess_;
  RodWay way_;
  BlockTridiagonal matrix_;
  DofVector change_, answer_, stays_;
  DofVector last_force_;  ///< of constraints, in the last step (N, N m)
  DofVector common_;      ///< velocity of the rod as a whole, as the step begins
  DeadMoments moments_;
  std::vector<Real> viscous_tension_;  ///< per beam
  bool in_step_ = false;
  Index passes_ = 0;  ///< in this step
  bool part_way_ = false;
  bool speeds_up_ = false;   ///< as the step begins
  Real kinetic_energy_ = 0;  ///< as the step began, beside that of the whole (J)
  bool stuck_ = false;
};

}  // namespace sutura::thread
