// Scissors: cut what thread is between their blades at stated times.
#pragma once

#include <vector>

#include "grasp_schedule.h"
#include "sutura/cuttable.h"
#include "sutura/end_note.h"
#include "sutura/simulation.h"
#include "tool_space.h"

namespace sutura::tools {

class Scissors : public Component, public Driver, public ToolSpace, public EndNote {
 public:
  static void describe(Describe<Scissors>& d);

  void initialise(Setup& setup) override;
  void archive(Archive& archive) override;
  void drive(const StepContext& context) override;
  Real next_event(Real time) const override { return first_after(time, times_); }
  std::string end_note() const override;

 private:
  void cut();

  Link<Body> body_;
  std::vector<Real> times_;
  struct Target {
    SegmentedCurve* curve;
    Cuttable* thread;
  };
  std::vector<Target> targets_;
  Index closed_ = 0;  ///< how often by now
  bool told_ = false;
  Index cuts_ = 0;
};

}  // namespace sutura::tools
