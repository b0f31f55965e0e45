// How much is known of how taut a thread is between two places that hold it.
//
// A hand that takes a thread in flight takes it where the motion before has led it, and that is
// known up to the time error of the steps since the thread was last at rest. A strand that is
// stretched, or pressed together, by less than that may be slack with another step.
#pragma once

#include <string>
#include <vector>

#include "rod_guess.h"

namespace sutura::thread {

class HeldStrands {
 public:
  /// Nothing has been held yet.
  void begin(const Rod& rod);
  /// A step has ended, which has cost so much (m; RodStep::time_error).
  void end_step(const Rod& rod, Real time_error);
  /// A strand whose tension is not known, in a sentence; empty if there is none.
  std::string doubt(const Rod& rod, const RodGuess& guess) const;
  void archive(Archive& archive, const Rod& rod);

 private:
  Real known_to(const Rod& rod, Index node) const;

  Real in_flight_ = 0;          ///< largest time error since the thread was at rest (m)
  std::vector<Real> known_to_;  ///< per spring of the rod: that, as it closed; -1: it is open
};

}  // namespace sutura::thread
