// Grasper: jaws that hold one section of a curve and carry it along a track.
#pragma once

#include <optional>
#include <vector>

#include "grasp_schedule.h"
#include "sutura/body.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"
#include "sutura/tool.h"

namespace sutura::tools {

class Grasper : public Component, public Driver, public Jaws {
 public:
  static void describe(Describe<Grasper>& d);

  void initialise(Setup& setup) override;
  void drive(const StepContext& context) override;

  // Jaws
  void close() override { told_ = true; }
  void open() override { told_ = false; }
  bool closed() const override { return events_ % 2 == 1; }
  Wrench wrench() const override { return closed() ? body_->hold_wrench(hold_) : Wrench{}; }

 private:
  Link<CurveBody> body_;
  Link<Tool> track_;
  Real at_ = 0;
  std::vector<Real> grasp_{0};
  std::vector<Real> release_;
  Real stiffness_ = HoldStiffness{}.translation;
  Real rotation_stiffness_ = HoldStiffness{}.rotation;

  GraspSchedule schedule_;
  Index hold_ = -1;   ///< number of the hold in the body
  Index events_ = 0;  ///< grasps and releases so far
  std::optional<bool> told_;  ///< closed or open, once a host decides
  Pose grip_;         ///< the section, seen from the tool, since the last grasp
  Pose target_;       ///< where the section is to be at the end of the step
};

}  // namespace sutura::tools
