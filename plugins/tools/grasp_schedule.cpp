#include "grasp_schedule.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "sutura/units.h"

namespace sutura::tools {
namespace {

std::vector<Real> interleave(const std::vector<Real>& grasps, const std::vector<Real>& releases) {
  std::vector<Real> events;
  for (std::size_t i = 0; i < grasps.size(); ++i) {
    events.push_back(grasps[i]);
    if (i < releases.size()) events.push_back(releases[i]);
  }
  return events;
}

}  // namespace

Real first_after(Real time, const std::vector<Real>& times) {
  const auto next = std::upper_bound(times.begin(), times.end(), time);
  return next == times.end() ? std::numeric_limits<Real>::infinity() : *next;
}

GraspSchedule::GraspSchedule(const std::vector<Real>& grasps, const std::vector<Real>& releases)
    : events_(interleave(grasps, releases)) {
  assert(check(grasps, releases).empty());
}

std::string GraspSchedule::check(const std::vector<Real>& grasps,
                                 const std::vector<Real>& releases) {
  if (grasps.empty()) return "'grasp' is empty; expected at least one time";
  if (releases.size() > grasps.size() || releases.size() + 1 < grasps.size()) {
    return std::to_string(grasps.size()) + " times of grasp and " +
           std::to_string(releases.size()) +
           " of release; expected a release after every grasp but, if it holds on, the last";
  }
  const std::vector<Real> events = interleave(grasps, releases);
  for (std::size_t i = 1; i < events.size(); ++i) {
    if (events[i] > events[i - 1]) continue;
    return std::string(i % 2 == 1 ? "release" : "grasp") + " at " + format_real(events[i]) +
           " s is not after the " + (i % 2 == 1 ? "grasp" : "release") + " at " +
           format_real(events[i - 1]) + " s; expected grasps and releases in turn";
  }
  return {};
}

Index GraspSchedule::events_until(Real time, Real slack) const {
  return std::upper_bound(events_.begin(), events_.end(), time + slack) - events_.begin();
}

}  // namespace sutura::tools
