// Jaws that are closed by the times of the scene, or as a host has said: what graspers and forceps
// share.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "grasp_schedule.h"
#include "sutura/archive.h"
#include "sutura/body.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"
#include "sutura/tool.h"

namespace sutura::tools {

class TimedJaws : public Driver, public Jaws {
 public:
  void grasp() override { told_ = Told::close; }
  void release() override { told_ = Told::open; }
  bool holding() const override { return closed_; }
  Real next_event(Real time) const override { return schedule_.next_after(time); }

 protected:
  /// `closing`: what they do in that time. T is the component.
  template <class T>
  static void describe_times(Describe<T>& d, std::string closing);
  /// Takes the times of the scene. What is wrong with them, in a sentence, or empty.
  std::string plan();
  /// At the start of a step. True if they have closed or opened; also if they have done both, so
  /// that what they hold is taken anew.
  bool update(const StepContext& context);
  /// At the end of a step: how much of what is between them and their middle is left. Jaws that
  /// take no time to close leave all.
  Real still_open(const StepContext& context) const;
  void archive_jaws(Archive& archive);

 private:
  enum class Told : std::uint8_t { nothing, close, open };
  std::vector<Real> grasp_{0}, release_;  ///< s
  Real closing_time_ = 0;                 ///< s
  GraspSchedule schedule_;
  Index events_ = 0;  ///< grasps and releases of the schedule so far
  bool closed_ = false;
  Told told_ = Told::nothing;  ///< since the last step
  Real changed_ = 0;           ///< when they last closed or opened (s)
};

template <class T>
void TimedJaws::describe_times(Describe<T>& d, std::string closing) {
  using Times = std::vector<Real> T::*;
  d.attribute("grasp", static_cast<Times>(&TimedJaws::grasp_), "s", at_least(0),
              "Times at which the jaws close.");
  d.attribute("release", static_cast<Times>(&TimedJaws::release_), "s", at_least(0),
              "Times at which they open; one less than grasps: they hold on.");
  d.attribute("closing", static_cast<Real T::*>(&TimedJaws::closing_time_), "s", between(0, 1e6),
              std::move(closing));
  d.input("hold", "1", between(0, 1),
          "1 closes the jaws at the start of the next step, 0 opens them, whatever the times say; "
          "the next time of grasp or release counts again.",
          [](T& jaws, Real hold) { hold > 0 ? jaws.grasp() : jaws.release(); });
  d.output("holding", "1", "1 while the jaws are closed, else 0.",
           [](const T& jaws) -> Real { return jaws.holding() ? 1 : 0; });
}

}  // namespace sutura::tools
