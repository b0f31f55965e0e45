#include "scissors.h"

#include <algorithm>

#include "sutura/archive.h"
#include "sutura/scene.h"

namespace sutura::tools {

void Scissors::initialise(Setup& setup) {
  if (const std::string wrong = place(); !wrong.empty()) {
    setup.error(*this, wrong);
    return;
  }
  if (!std::is_sorted(times_.begin(), times_.end()))
    setup.error(*this, "'times' must not decrease");
  for (Component* c : setup.scene->components()) {
    const Target target{dynamic_cast<SegmentedCurve*>(c), dynamic_cast<Cuttable*>(c)};
    if (target.curve == nullptr || target.thread == nullptr) continue;
    if (body_ && body_.get() != static_cast<const Body*>(target.curve)) continue;
    targets_.push_back(target);
  }
  if (targets_.empty())
    setup.error(*this, body_ ? "'body' cannot be cut; expected a thread"
                             : "there is no thread that could be cut");
}

void Scissors::drive(const StepContext& context) {
  const Real now = context.time + std::max(context.early, 1e-6 * context.dt);
  const Index due = std::upper_bound(times_.begin(), times_.end(), now) - times_.begin();
  if (due > closed_ || told_) {
    const Index before = cuts_;
    cut();
    count_closing(cuts_ > before, context.time);
  }
  closed_ = std::max(closed_, due);
  told_ = false;
}

void Scissors::cut() {
  // The step has not begun: threads are where the last one has left them, and so are the blades.
  const Pose frame = placed(Configuration::start);
  for (const Target& target : targets_)
    for (const JawSpace::Stretch& s : look(*target.curve, Configuration::current, frame)) {
      const Real from = std::max(s.low, target.curve->needle_length());
      if (!(from < s.high)) continue;
      target.thread->cut((from + s.high) / 2);
      ++cuts_;
    }
}

std::string Scissors::end_note() const {
  return closed_in_vain(body_ ? "nothing of 'body' that they cut was" : "no thread was");
}

void Scissors::archive(Archive& a) {
  archive_closings(a);
  a("closed", closed_);
  a("told", told_);
  a("cuts", cuts_);
}

void Scissors::describe(Describe<Scissors>& d) {
  d.summary("Blades that close at stated times and cut the thread that is between them.");
  d.theory(
      "The space between the blades is a box, which goes with the track. Each strand of a thread "
      "that passes through it when they close is cut in the middle of what is in the box: the beam "
      "there bears nothing from then on, touches nothing and is not drawn, and half of its mass "
      "stays with each of its ends. So the thread gets shorter by up to a beam on each side, and "
      "stays one chain for the solver. It is cut for good. A thread with 'sampling_angle' is first "
      "split there down to its shortest beams. Of a needle nothing is cut: the middle is that of "
      "the thread behind it. The blades touch nothing.\n\n"
      "Of a sewn thread, a SuturePath holds what is left on each side: inside of a tissue, both "
      "pieces stay in the channel, each with its friction; an end that is drawn through leaves "
      "the channel empty behind it, and does not find back into it.");
  d.link("body", &Scissors::body_, "Only this is cut; left out: any thread.").named_only();
  describe_space(d, "scissors", "blades", "blades");
  d.attribute("times", &Scissors::times_, "s", at_least(0), "Times at which the blades close.");
  d.input("close", "1", between(0, 1), "1 closes the blades at the start of the next step.",
          [](Scissors& s, Real close) { s.told_ = close > 0; });
  d.output("cuts", "1", "Number of strands that they have cut.",
           [](const Scissors& s) { return static_cast<Real>(s.cuts_); });
}

}  // namespace sutura::tools
