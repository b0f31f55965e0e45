// ThreadLoad: a force and a moment on one section of a needle or thread.
#pragma once

#include <vector>

#include "sutura/describe.h"
#include "sutura/schedule.h"
#include "sutura/simulation.h"
#include "suture_thread.h"

namespace sutura::thread {

class ThreadLoad : public Component, public Driver {
 public:
  static void describe(Describe<ThreadLoad>& d);
  void initialise(Setup& setup) override;
  void drive(const StepContext& context) override;
  void archive(Archive& archive) override;

 private:
  Link<SutureThread> thread_;
  Real at_ = 0;
  Vec3 force_ = Vec3::Zero(), moment_ = Vec3::Zero();
  std::vector<Real> times_, factors_;

  Schedule schedule_;
  Index section_ = -1;  ///< number of a hold that stays open: it keeps a node at the section
  Real factor_ = 0;
};

}  // namespace sutura::thread
