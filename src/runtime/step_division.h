// How a step is divided: into 2^level parts, finer after a failure, coarser again after successes.
#pragma once

#include "sutura/types.h"

namespace sutura {

class StepDivision {
 public:
  explicit StepDivision(Index most_parts) : most_(most_parts) {}

  bool done() const { return part_ == parts_; }
  Index parts() const { return parts_; }
  /// Where the present part begins, in units of the step.
  Real begin() const { return static_cast<Real>(part_) / static_cast<Real>(parts_); }
  /// Halves the present part. False if it cannot be any shorter.
  bool halve() {
    if (2 * parts_ > most_) return false;
    parts_ *= 2;
    part_ *= 2;
    return true;
  }
  /// On to the next part; twice as long a one where it fits, so that a step takes no more than it
  /// needs.
  void next() {
    ++part_;
    if (part_ < parts_ && part_ % 2 == 0 && parts_ > 1) {
      part_ /= 2;
      parts_ /= 2;
    }
  }

 private:
  Index most_, part_ = 0, parts_ = 1;
};

}  // namespace sutura
