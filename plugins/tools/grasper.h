// Grasper: jaws that hold one section of a curve and carry it along a track.
#pragma once

#include "sutura/body.h"
#include "timed_jaws.h"

namespace sutura::tools {

class Grasper : public Component, public TimedJaws {
 public:
  static void describe(Describe<Grasper>& d);

  void initialise(Setup& setup) override;
  void ready(Setup& setup) override;
  void archive(Archive& archive) override;
  void drive(const StepContext& context) override;

  Wrench wrench() const override { return holding() ? body_->hold_wrench(hold_) : Wrench{}; }

 private:
  Link<CurveBody> body_;
  Link<Tool> track_;
  Real at_ = 0;
  Real stiffness_ = HoldStiffness{}.translation;
  Real rotation_stiffness_ = HoldStiffness{}.rotation;

  Index hold_ = -1;  ///< number of the hold in the body
  Pose grip_;        ///< the section, seen from the tool, since the last grasp
  Pose target_;      ///< where the section is to be at the end of the step
};

}  // namespace sutura::tools
