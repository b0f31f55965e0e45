// Sweeps on a device for a BlockGaussSeidel, without the component of a scene.
#pragma once

#include "sutura/device.h"
#include "sweeps.h"

namespace sutura::opencl {

class SweepsAlone : public SweepDevice {
 public:
  SweepsAlone(Sweeps& sweeps, Precision precision)
      : sweeps_(sweeps),
        rough_(precision != Precision::double_),
        digits_(has_double_sums(precision)) {}
  bool load(const ConstraintProblem& problem) override {
    why_not_ = sweeps_.load(problem);
    return why_not_.empty();
  }
  bool sweep(ConstraintProblem& problem, std::span<const std::uint32_t> orders) override {
    sweeps_.sweep(problem, orders);
    return true;
  }
  bool solve_tangents(const TangentSystem& system, TangentAnswer& answer) override {
    if (!digits_) return false;
    sweeps_.solve_tangents(system, answer);
    return true;
  }
  bool is_rough() const override { return rough_; }
  const std::string& why_not() const override { return why_not_; }

 private:
  Sweeps& sweeps_;
  bool rough_, digits_;
  std::string why_not_;
};

}  // namespace sutura::opencl
