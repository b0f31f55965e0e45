// A number that changes over time, from a few instants: how large a load is at any moment.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sutura/types.h"

namespace sutura {

class Schedule {
 public:
  /// 1 at all times.
  Schedule() = default;
  /// Requires check(...) to be empty.
  Schedule(std::vector<Real> times, std::vector<Real> values)
      : times_(std::move(times)), values_(std::move(values)) {}

  /// What is wrong with attributes `times` and `factors`, in a sentence, or empty. Both may be
  /// empty.
  static std::string check(const std::vector<Real>& times, const std::vector<Real>& values);

  /// Linear between two times, constant before the first and after the last.
  Real at(Real time) const;

 private:
  std::vector<Real> times_;   ///< s
  std::vector<Real> values_;  ///< 1
};

}  // namespace sutura
