// A worker that factorises snapshots of the system matrix while the simulation runs on.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "block_matrix.h"
#include "factor.h"
#include "growing_compliance.h"
#include "sutura/types.h"
#include "sutura/worker_pool.h"

namespace sutura::tissue {

/// The matrix of one step and the rotations of its nodes. Written by the simulation, then not
/// changed until the factor made from it has been replaced.
struct Snapshot {
  NodeMatrix A;
  std::vector<Mat3> rotations;
  std::vector<Index> candidates;  ///< to be eliminated last
  Index step = -1;
};

void archive(Archive& archive, Snapshot& snapshot);

/// What the worker publishes.
struct SnapshotFactor {
  std::shared_ptr<Snapshot> snapshot;
  std::shared_ptr<const FactorPlan> plan;
  std::unique_ptr<Factor> factor;
  GrowingCompliance compliance;  ///< of the candidates, in the axes of the snapshot
  bool ok = false;               ///< false: not positive definite, or no memory
  bool rough = false;            ///< keep the factor in single precision too
  double seconds = 0;            ///< wall time of the factorisation

  /// Fills the rest from the snapshot; `base` is any plan of its pattern. The same bits on
  /// whichever worker it runs, and whatever factor was here before.
  /// True if the order of elimination had to be chosen anew.
  bool factorise(const std::shared_ptr<const FactorPlan>& base);
};

class FactorWorker {
 public:
  /// For tests: called before each factorisation with the step of the snapshot; it may sleep, and
  /// the job is lost without an answer if it returns false.
  using Hook = std::function<bool(Index step)>;
  /// Without a pool it starts a worker of its own.
  FactorWorker(std::shared_ptr<const FactorPlan> plan, std::shared_ptr<WorkerPool> pool,
               Hook hook = {});
  ~FactorWorker();
  FactorWorker(const FactorWorker&) = delete;
  FactorWorker& operator=(const FactorWorker&) = delete;

  /// Not while a snapshot is handed in whose factor has not been taken out yet. `job` carries the
  /// snapshot, and if it has one, a factor whose memory is reused.
  void submit(std::unique_ptr<SnapshotFactor> job);
  /// The answer, or null if there is none yet. With patience it is made here if no worker has
  /// begun, and else waited for so long.
  std::unique_ptr<SnapshotFactor> take(std::chrono::duration<double> patience);

 private:
  class Desk;
  std::shared_ptr<Desk> desk_;
  std::shared_ptr<WorkerPool> pool_;
  bool busy_ = false;  ///< a job has been handed in and not been taken out
};

}  // namespace sutura::tissue
