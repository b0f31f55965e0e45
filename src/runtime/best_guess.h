// The end of a step that cannot be solved: of all its guesses the one that lacks least.
//
// Passes that do not converge can lead anywhere, and the last of them is often the worst. What
// lacks is compared in newtons: beside the forces at work, as the tolerance has it, a guess that
// tears a thread to pieces lacks no more than any other.
#pragma once

#include <vector>

#include "sutura/simulation.h"

namespace sutura {

class BestGuess {
 public:
  using Bodies = std::vector<Simulation::NamedBody>;
  /// Makes room for their motions, so that nothing is allocated in a step.
  explicit BestGuess(const Bodies& bodies);
  /// A new step.
  void forget() { least_ = -1; }
  /// The present guess, with what its balance lacks per body; `reached`: on ways that were free.
  /// True if it is the best one so far.
  bool look(const std::vector<Imbalance>& imbalance, bool reached);
  /// Moves the bodies to the best guess that was finite. False if there was none.
  bool go_back(const StepContext& context) const;
  bool was_reached() const { return reached_; }

 private:
  const Bodies& bodies_;
  Real least_ = -1;           ///< N; negative: no guess yet
  std::vector<VecX> motion_;  ///< per body, m and rad
  bool reached_ = false;
};

}  // namespace sutura
