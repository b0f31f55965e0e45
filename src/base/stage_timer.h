// Wall time per stage of the step.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>

namespace sutura {

/// Adds the time between `enter` calls to the stage entered; the last one ends with the object.
template <class Stage, std::size_t N>
class StageTimer {
 public:
  explicit StageTimer(std::array<double, N>& seconds) : seconds_(seconds) { seconds_.fill(0); }
  ~StageTimer() { leave(); }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

  void enter(Stage stage) {
    leave();
    current_ = static_cast<std::size_t>(stage);
  }
  /// Undefined before the first one.
  Stage current() const { return static_cast<Stage>(current_); }

 private:
  using Clock = std::chrono::steady_clock;
  void leave() {
    const Clock::time_point now = Clock::now();
    if (current_ < N) seconds_[current_] += std::chrono::duration<double>(now - since_).count();
    since_ = now;
  }

  std::array<double, N>& seconds_;
  std::size_t current_ = N;
  Clock::time_point since_ = Clock::now();
};

}  // namespace sutura
