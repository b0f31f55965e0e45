// W of rows that touch nodes of known compliance, on an OpenCL device: compliance.cl.
#pragma once

#include <memory>
#include <vector>

#include "device.h"
#include "precision.h"

namespace sutura::opencl {

class ContactCompliance {
 public:
  ContactCompliance(const Device& device, Precision precision);
  ~ContactCompliance();
  /// As ConjugateGradientDevice has it. What is on the device of C stays there. Waits.
  void add(const KnownCompliance& known, const SparseRows& rows, Real scale, Eigen::Ref<MatX> W);

 private:
  struct Program;
  void send_columns(const KnownCompliance& known);
  void send(Buffer& to, std::span<const Real> from);

  const Device& device_;
  Precision precision_;
  std::unique_ptr<Program> program_;
  Index sent_of_ = -1, sent_ = 0, stride_ = 0;  ///< whose columns, how many, how far apart
  Buffer C_, first_, place_, h_, Z_, W_;
  std::unique_ptr<Pinned> result_;
  std::size_t result_bytes_ = 0;
  std::vector<float> rounded_;
};

}  // namespace sutura::opencl
