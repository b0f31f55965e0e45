#include "thread_load.h"

#include "sutura/archive.h"
#include "sutura/units.h"

namespace sutura::thread {

void ThreadLoad::describe(Describe<ThreadLoad>& d) {
  d.summary(
      "A dead load on one section of a needle or thread: a force and a moment that keep their "
      "direction whatever the section does.");
  d.theory(
      "The load at the end of a step is *factor(t)* times force and moment; the factor is "
      "interpolated along lines between `times`, and 1 without them. A node of the thread stays at "
      "the section.");
  d.link("thread", &ThreadLoad::thread_, "The needle and thread.");
  d.attribute("at", &ThreadLoad::at_, "m", at_least(0), "Abscissa of the section.").required();
  d.attribute("force", &ThreadLoad::force_, "N", any(), "Force on the section.");
  d.attribute("moment", &ThreadLoad::moment_, "N m", any(), "Moment on the section.");
  d.attribute("times", &ThreadLoad::times_, "s", any(), "Times of the factors, increasing.");
  d.attribute("factors", &ThreadLoad::factors_, "1", any(),
              "By what the load is multiplied at each of the times.");
  d.output("factor", "1", "Factor of the load at the end of the step.",
           [](const ThreadLoad& l) { return l.factor_; });
}

void ThreadLoad::initialise(Setup& setup) {
  if (at_ > thread_->length() * (1 + 1e-9))
    return setup.error(*this, "'at' is " + format_real(at_) + " m, but the thread is " +
                                  format_real(thread_->length()) + " m long");
  if (const std::string wrong = Schedule::check(times_, factors_); !wrong.empty())
    return setup.error(*this, wrong);
  if (force_.isZero(0) && moment_.isZero(0))
    return setup.error(*this, "neither 'force' nor 'moment' is given");
  setup.warn_of_hidden_keys(*this, times_);
  setup.warn_of_hidden_start(*this, times_);
  schedule_ = Schedule(times_, factors_);
  section_ = thread_->add_hold(at_);
}

void ThreadLoad::archive(Archive& a) {
  a("factor", factor_);
}

void ThreadLoad::drive(const StepContext& context) {
  factor_ = schedule_.at(context.end());
  thread_->add_load(section_, {factor_ * force_, factor_ * moment_});
}

}  // namespace sutura::thread
