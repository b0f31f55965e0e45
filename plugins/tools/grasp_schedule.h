// When a grasper is closed: alternating times of grasp and release.
#pragma once

#include <string>
#include <vector>

#include "sutura/types.h"

namespace sutura::tools {

/// The first of the `times`, which do not decrease, that is after `time` (s); infinity if none is.
Real first_after(Real time, const std::vector<Real>& times);

class GraspSchedule {
 public:
  /// Grasps and releases alternate, a grasp first; the last grasp may have no release.
  /// Requires check(...) to be empty.
  GraspSchedule() = default;
  GraspSchedule(const std::vector<Real>& grasps, const std::vector<Real>& releases);

  /// What is wrong with the times, in a sentence, or empty.
  static std::string check(const std::vector<Real>& grasps, const std::vector<Real>& releases);

  /// Number of events up to and including `time`: odd while closed. An event within `slack` (s)
  /// after `time` counts, so that a step that begins at 0.1 + 0.2 s sees the event at 0.3 s.
  Index events_until(Real time, Real slack) const;
  /// The first event after `time` (s); infinity if there is none.
  Real next_after(Real time) const { return first_after(time, events_); }

 private:
  std::vector<Real> events_;
};

}  // namespace sutura::tools
