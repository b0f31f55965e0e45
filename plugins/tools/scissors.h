// Scissors: cut what thread is between their blades at stated times.
#pragma once

#include <vector>

#include "jaw_space.h"
#include "sutura/cuttable.h"
#include "sutura/describe.h"
#include "sutura/schedule.h"
#include "sutura/simulation.h"
#include "sutura/tool.h"

namespace sutura::tools {

class Scissors : public Component, public Driver {
 public:
  static void describe(Describe<Scissors>& d);

  void initialise(Setup& setup) override;
  void archive(Archive& archive) override;
  void drive(const StepContext& context) override;

 private:
  Pose placed() const;
  void cut();

  Link<Body> body_;
  Link<Tool> track_;
  Vec3 centre_ = Vec3::Zero(), axis_ = Vec3::UnitZ(), rotation_ = Vec3::Zero();
  Vec3 size_{2e-3, 2e-3, 2e-3};
  std::vector<Real> times_;

  Pose as_modelled_;
  JawSpace space_;
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
