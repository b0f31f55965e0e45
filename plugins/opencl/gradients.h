// Conjugate gradients on an OpenCL device: the kernels of gradients.cl and what they need.
#pragma once

#include <memory>
#include <vector>

#include "device.h"
#include "precision.h"

namespace sutura::opencl {

class Gradients {
 public:
  Gradients(const Device& device, Precision precision) : device_(device), precision_(precision) {}

  void set_matrix(const NodeMatrixView&, std::span<const char>) {}
  void set_factor(const SupernodalFactor&) {}
  void set_turns(std::span<const Mat3>) {}
  ConjugateGradientDevice::Report solve(const Eigen::Ref<const VecX>&, Eigen::Ref<VecX>, Real,
                                        Index) {
    return {};
  }

 private:
  const Device& device_;
  Precision precision_;
};

}  // namespace sutura::opencl
