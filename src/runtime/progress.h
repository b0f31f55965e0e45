// Whether the passes of a step still get nearer to its balance.
//
// Of a step that is too long they often do not: the guess stands before a wall that is in its way,
// or swings about. As a step that fails is halved and tried again, it should fail soon.
#pragma once

#include <limits>

#include "sutura/types.h"

namespace sutura {

class Progress {
 public:
  /// A new step, or an event.
  void begin() { *this = {}; }
  /// After a pass that all bodies took the whole way. `lacks`: what its guess lacks, in units of
  /// the tolerance.
  void add(Real lacks) {
    ++passes_;
    ++no_nearer_;
    if (lacks < nearer * least_) {
      least_ = lacks;
      no_nearer_ = 0;
    }
  }
  /// Of 28000 passes of a stitch that is tied, so many would have been saved as gave the numbers
  /// below: an eighth. Of the tries that do succeed, one in forty is given up.
  bool stands() const { return passes_ >= 7 && no_nearer_ >= 4 && least_ > 5; }

 private:
  static constexpr Real nearer = 0.8;
  Real least_ = std::numeric_limits<Real>::infinity();
  Index passes_ = 0, no_nearer_ = 0;  ///< `no_nearer_`: since the last that came nearer
};

}  // namespace sutura
