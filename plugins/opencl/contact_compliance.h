// W of rows that touch nodes of known compliance, on an OpenCL device: compliance.cl.
#pragma once

#include <memory>

#include "program.h"

namespace sutura::opencl {

class ContactCompliance {
 public:
  ContactCompliance(const Device& device, Precision precision);
  /// As ConjugateGradientDevice has it. What is on the device of C stays there. Waits.
  void add(const KnownCompliance& known, const SparseRows& rows, Real scale, Eigen::Ref<MatX> W);

 private:
  void send_columns(const KnownCompliance& known);

  const Device& device_;
  const std::size_t real_;  ///< bytes
  Program program_;
  Index sent_of_ = -1, sent_ = 0, stride_ = 0;  ///< whose columns, how many, how far apart
  Buffer first_{device_}, place_{device_}, W_{device_};
  Numbers C_{device_, real_}, h_{device_, real_}, Z_{device_, real_};
  std::unique_ptr<Pinned> result_;
  std::size_t result_bytes_ = 0;
};

}  // namespace sutura::opencl
