#include "timed_jaws.h"

#include <algorithm>

namespace sutura::tools {

std::string TimedJaws::plan() {
  std::string wrong = GraspSchedule::check(grasp_, release_);
  if (wrong.empty()) schedule_ = GraspSchedule(grasp_, release_);
  return wrong;
}

bool TimedJaws::update(const StepContext& context) {
  const Index events =
      schedule_.events_until(context.time, std::max(context.early, 1e-6 * context.dt));
  bool changed = events != events_;
  bool closed = changed ? events % 2 == 1 : closed_;
  if (told_ != Told::nothing) closed = told_ == Told::close;
  changed = (changed && told_ == Told::nothing) || closed != closed_;
  events_ = events;
  closed_ = closed;
  told_ = Told::nothing;
  if (changed) changed_ = context.time;
  return changed;
}

Real TimedJaws::still_open(const StepContext& context) const {
  if (!(closing_time_ > 0)) return 1;
  return std::clamp(1 - (context.time + context.dt - changed_) / closing_time_, 0., 1.);
}

void TimedJaws::archive_jaws(Archive& a) {
  a("events", events_);
  a("holding", closed_);
  a("told", told_);
  a("taken", changed_);
}

}  // namespace sutura::tools
