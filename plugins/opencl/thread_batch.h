// Many threads on a device as a component of a scene.
#pragma once

#include <memory>
#include <vector>

#include "opencl_device.h"
#include "sutura/batch.h"
#include "sutura/simulation.h"
#include "threads.h"

namespace sutura::opencl {

class ThreadBatch : public Component, public Batch, public Driver {
 public:
  static void describe(Describe<ThreadBatch>& d);
  void initialise(Setup& setup) override;
  void archive(Archive& archive) override;
  void drive(const StepContext& context) override;

  Index environments() const override { return environments_; }
  Index actions() const override { return 3; }
  Index observations() const override { return threads_->observations(); }
  void reset(std::span<const std::uint8_t> which) override;
  void step(std::span<const Real> actions) override;
  void observe(std::span<Real> out) const override;

 private:
  ThreadsProblem problem(const Setup& setup) const;
  /// One number of what is observed now.
  Real observed(Index at) const;

  Index environments_ = 64, beams_ = 100;
  Real length_ = 0.1, diameter_ = 0.2e-3, young_ = 2e9, poisson_ = 0.4, density_ = 1140;
  Vec3 start_ = Vec3::Zero(), direction_ = Vec3::UnitX(), velocity_ = Vec3::Zero();
  std::vector<Real> path_;
  Real lateral_ = 200, friction_ = 0.01, hand_ = 1000, hand_turning_ = 1e-3;
  Real dt_ = 0;
  Link<OpenClDevice> device_;
  std::unique_ptr<Threads> threads_;
  std::vector<Real> velocities_;  ///< of all hands, in a run of the scene
  mutable std::vector<Real> observed_;
  mutable bool is_observed_ = false;
};

}  // namespace sutura::opencl
