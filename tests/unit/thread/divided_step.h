// A step of a rod alone as the step of a simulation makes it: in shorter parts where the whole
// cannot be solved.
#pragma once

#include "rod_step.h"
#include "runtime/step_division.h"

namespace sutura::thread {

/// Rounding leaves up to 1e-14 of EA, and a beam counts 1e-10 of EA as at work, whatever else is.
inline constexpr Real well_balanced = 1e-4;

/// False if some part cannot be solved even at its shortest.
inline bool divided_step(Rod& rod, RodStep& step, Real dt, const Vec3& gravity,
                         Real tolerance = well_balanced) {
  const VecX none = VecX::Zero(rod.dofs());
  bool solved = true;
  for (StepDivision division(64); !division.done(); division.next()) {
    const Rod rod_before = rod;
    const RodStep step_before = step;
    while (step.advance(rod, dt / static_cast<Real>(division.parts()), gravity, none, tolerance) ==
           0) {
      if (!division.halve()) {
        solved = false;
        break;
      }
      rod = rod_before;
      step = step_before;
    }
  }
  return solved;
}

}  // namespace sutura::thread
