// Grasper: jaws that hold one section of a curve and carry it along a track.
#pragma once

#include <optional>
#include <vector>

#include "closing.h"
#include "sutura/body.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"
#include "sutura/tool.h"

namespace sutura::tools {

class Grasper : public Component, public Driver, public Jaws {
 public:
  static void describe(Describe<Grasper>& d);

  void initialise(Setup& setup) override;
  void ready(Setup& setup) override;
  void archive(Archive& archive) override;
  void drive(const StepContext& context) override;

  // Jaws
  void grasp() override { closing_.tell(true); }
  void release() override { closing_.tell(false); }
  bool holding() const override { return closing_.closed(); }
  Wrench wrench() const override { return holding() ? body_->hold_wrench(hold_) : Wrench{}; }

 private:
  Link<CurveBody> body_;
  Link<Tool> track_;
  Real at_ = 0;
  std::vector<Real> grasp_{0};
  std::vector<Real> release_;
  Real stiffness_ = HoldStiffness{}.translation;
  Real rotation_stiffness_ = HoldStiffness{}.rotation;
  Real closing_time_ = 0;

  Closing closing_;
  Index hold_ = -1;  ///< number of the hold in the body
  Pose grip_;        ///< the section, seen from the tool, since the last grasp
  Real taken_ = 0;   ///< when that was (s)
  Pose target_;      ///< where the section is to be at the end of the step
};

}  // namespace sutura::tools
