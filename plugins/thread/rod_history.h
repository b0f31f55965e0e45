// How a rod moves at the start of a step and how it moved in the step before: what a step begins
// from.
//
// One step back, the end of a step of length h is that of implicit Euler,
//   v = u / h,                        M (v - v_start) = h f,
// with u the motion from the start, v the velocity at the end and f the forces there. Two steps
// back it is that of BDF2 (Gear 1971), here with steps of any lengths: with w the length of this
// step beside that of the one before, and c = w^2 / (1 + 2 w),
//   v = (u - c u_before) / h',        M (v - v_start - c (v_start - v_before)) = h' f,
//   h' = h (1 + w) / (1 + 2 w),
// u_before the motion of the step before and v_before the velocity at its start. That is a step of
// implicit Euler of length h' from another start, so a step knows only that start. It is stable
// where no step is longer than 2.4 times the one before (Grigorieff 1983).
#pragma once

#include <vector>

#include "rod.h"
#include "viscosity.h"

namespace sutura::thread {

/// At one time: what is compared with what it is at the end of the step.
struct RodMoment {
  DofVector velocity;                    ///< m/s, rad/s; 6 per node
  std::vector<Vec3> tangent_rate;        ///< per node, 1/s
  std::vector<Deformation> deformation;  ///< per beam; kept only where there is viscosity

  void resize(Index nodes);
  void reserve(Index nodes);
  void archive(Archive& archive);
  void take(const Rod& rod, bool with_deformation);
  /// now + share (now - before).
  void extrapolate(const RodMoment& now, const RodMoment& before, Real share);
};

/// The shift and the turn of every node in one step, its roll (see `turned`) apart.
struct RodMotion {
  DofVector shift_and_tilt;  ///< m, rad; 6 per node
  std::vector<Real> roll;    ///< per node, rad

  void resize(Index nodes);
  void reserve(Index nodes);
  void archive(Archive& archive);
  void set_zero();
  /// `motion`: from the start of the step, 6 per node.
  void take(const Rod& rod, const Dofs& motion);
  void scale(const RodMotion& other, Real by);
};

/// The step before, where a step may look back at it.
struct RodHistory {
  Real length = 0;  ///< s; 0: there is none to look back at
  RodMoment start;
  RodMotion motion;

  void resize(Index nodes);
  void reserve(Index nodes);
  void archive(Archive& archive, const Rod& rod);
};

}  // namespace sutura::thread
