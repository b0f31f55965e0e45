// Workers of a host that do what need not be done within a step: a tissue's next factor.
#pragma once

#include <memory>

namespace sutura {

/// Something to be done beside the steps.
class Job {
 public:
  virtual ~Job() = default;
  /// Does what there is to do, if there is anything. On any worker, any number of times.
  virtual void run() noexcept = 0;
};

/// May serve many simulations. Shared by all that still may hand something in.
class WorkerPool {
 public:
  virtual ~WorkerPool() = default;
  /// `job.run()` is to be called soon, now if the pool likes. Who hands it in does it himself if
  /// he needs it before; so nothing waits for a pool that is late, or that drops it. Called by
  /// several workers at once.
  virtual void enqueue(std::shared_ptr<Job> job) = 0;
};

}  // namespace sutura
