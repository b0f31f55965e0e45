// A step of a rod alone as the step of a simulation makes it: in shorter parts where the whole
// cannot be solved.
#pragma once

#include "rod.h"
#include "runtime/step_division.h"

namespace sutura::thread {

/// Rounding leaves up to 1e-14 of EA, and a beam counts 1e-10 of EA as at work, whatever else is.
inline constexpr Real well_balanced = 1e-4;

/// False if some part cannot be solved even at its shortest.
inline bool divided_step(Rod& rod, Real dt, const Vec3& gravity, Real tolerance = well_balanced) {
  const VecX none = VecX::Zero(rod.dofs());
  bool solved = true;
  for (StepDivision division(64); !division.done(); division.next()) {
    const Rod before = rod;
    while (rod.advance(dt / static_cast<Real>(division.parts()), gravity, none, tolerance) == 0) {
      if (!division.halve()) {
        solved = false;
        break;
      }
      rod = before;
    }
  }
  return solved;
}

}  // namespace sutura::thread
