// What a run was like, gathered step by step.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "sutura/simulation.h"

namespace sutura::app {

class Summary {
 public:
  void add(const StepReport& report);

  /// A table of stages, the size of the constraint problem, and how well it was solved.
  std::string text(double wall_seconds) const;
  Index steps() const { return steps_; }
  /// Steps whose result is not as accurate as the scene asks,
  /// and those that a run before this one missed, from which it goes on.
  Index missed() const { return missed_before_ + unsolved_ + faulty_; }

 private:
  /// The last value, and the largest with its step.
  struct Track {
    double last = 0;
    double worst = 0;
    Index worst_step = 0;
    void add(double value, Index step) {
      last = value;
      if (worst_step > 0 && !(value > worst)) return;
      worst = value;
      worst_step = step;
    }
  };

  Index steps_ = 0;
  Index last_step_ = 0;
  Real time_ = 0;            ///< s, at the end of the last step
  Index missed_before_ = 0;  ///< steps before the first one that was added
  Index unsolved_ = 0;       ///< steps that missed a tolerance
  Index first_unsolved_ = 0;
  std::string worst_body_;
  Imbalance worst_imbalance_;
  Real worst_violation_ = 0, worst_time_error_ = 0;
  Index passes_ = 0, most_passes_ = 0, divided_ = 0, most_parts_ = 1;
  Index of_second_order_ = 0;
  Index events_ = 0;
  /// Sentences that differ by their numbers only are of one kind.
  struct Kind {
    std::string first;  ///< as it was said first
    Index steps = 0, first_step = 0, last_step = 0;
  };
  static void count(std::map<std::string, Kind>& kinds, const std::vector<std::string>& sentences,
                    Index step);
  std::map<std::string, Kind> faults_, notes_;
  Index faulty_ = 0;  ///< solved steps with faults
  std::array<double, stage_names.size()> seconds_{};
  Track blocks_, rows_, sweeps_, residual_, violation_, imbalance_, time_error_;
};

}  // namespace sutura::app
