// How a step is divided: into 2^level parts, finer after a failure, coarser again after successes.
#pragma once

#include <cmath>
#include <limits>

#include "sutura/types.h"

namespace sutura {

class StepDivision {
 public:
  explicit StepDivision(Index most_parts) : most_(most_parts) {}

  bool done() const { return part_ == parts_; }
  Index parts() const { return parts_; }
  /// Where the present part begins, in units of the step.
  Real begin() const { return static_cast<Real>(part_) / static_cast<Real>(parts_); }
  /// May the present part be any shorter?
  bool can_halve() const { return !is_last_try_ && 2 * parts_ <= most_; }
  /// Halves the present part, where it may.
  bool halve() {
    if (!can_halve()) return false;
    parts_ *= 2;
    part_ *= 2;
    return true;
  }
  /// The present part was not solved, and lacks so much; 0 if it is balanced, but too long. True if
  /// it is to be tried at another length: at shorter ones first, and where none is solved at the
  /// one that lacked least, which is then taken as it is. The shortest need not be that one.
  bool try_again(Real lacks) {
    if (is_last_try_) return false;
    if (lacks <= least_) {
      least_ = lacks;
      best_ = parts_;
    }
    if (halve()) return true;
    // The same once more is of use only with more passes.
    const bool may_balance = lacks > 0 && std::isfinite(lacks) && most_ > 1;
    if (best_ == parts_ && !may_balance) return false;
    part_ /= parts_ / best_;
    parts_ = best_;
    is_last_try_ = true;
    return true;
  }
  /// Is the present part tried for the last time?
  bool is_last_try() const { return is_last_try_; }
  /// On to the next part; twice as long a one where it fits, so that a step takes no more than it
  /// needs.
  void next() {
    least_ = std::numeric_limits<Real>::infinity();
    is_last_try_ = false;
    ++part_;
    if (part_ < parts_ && part_ % 2 == 0 && parts_ > 1) {
      part_ /= 2;
      parts_ /= 2;
    }
  }

 private:
  Index most_, part_ = 0, parts_ = 1;
  Real least_ = std::numeric_limits<Real>::infinity();  ///< of the present part
  Index best_ = 1;  ///< number of parts with which it lacked that
  bool is_last_try_ = false;
};

}  // namespace sutura
