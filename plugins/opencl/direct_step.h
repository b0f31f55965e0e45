// The direct step on an OpenCL device: direct_step.cl.
#pragma once

#include <vector>

#include "program.h"

namespace sutura::opencl {

/// For precisions with double sums.
class DirectStep {
 public:
  DirectStep(const Device& device, Precision precision);
  /// As SweepDevice::solve_tangents has it, with the W that was sent. Waits.
  void solve(const TangentSystem& system, const Buffer& W, TangentAnswer& answer);

 private:
  Program program_;
  Buffer integers_, reals_, delta_, system_[2], answer_;
  std::vector<std::int32_t> host_integers_;
  std::vector<Real> host_reals_;
};

}  // namespace sutura::opencl
