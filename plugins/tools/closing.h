// Whether jaws are closed: by the times of the scene, or as a host has said.
#pragma once

#include <algorithm>
#include <utility>

#include "grasp_schedule.h"
#include "sutura/archive.h"
#include "sutura/body.h"

namespace sutura::tools {

/// Of jaws that began to close at the time `began` and take `time` for it (s), at the end of a
/// step: how much of what is between them and their middle is left. Those that take no time leave
/// all.
inline Real still_open(const StepContext& context, Real began, Real time) {
  if (!(time > 0)) return 1;
  return std::clamp(1 - (context.time + context.dt - began) / time, 0., 1.);
}

class Closing {
 public:
  void plan(GraspSchedule schedule) { schedule_ = std::move(schedule); }
  /// By a host, for the next step.
  void tell(bool close) { told_ = close ? Told::close : Told::open; }
  /// At the start of a step. True if they have closed or opened; also if they have done both, so
  /// that what they hold is taken anew.
  bool update(const StepContext& context) {
    const Index events = schedule_.events_until(context.time, 1e-6 * context.dt);
    bool changed = events != events_;
    bool closed = changed ? events % 2 == 1 : closed_;
    if (told_ != Told::nothing) closed = told_ == Told::close;
    changed = (changed && told_ == Told::nothing) || closed != closed_;
    events_ = events;
    closed_ = closed;
    told_ = Told::nothing;
    return changed;
  }
  bool closed() const { return closed_; }
  void archive(Archive& a) {
    a("events", events_);
    a("holding", closed_);
    a("told", told_);
  }

 private:
  enum class Told : std::uint8_t { nothing, close, open };
  GraspSchedule schedule_;
  Index events_ = 0;  ///< grasps and releases of the schedule so far
  bool closed_ = false;
  Told told_ = Told::nothing;  ///< since the last step
};

}  // namespace sutura::tools
