// PCG on the matrix of the step, preconditioned by a factor that a worker made of an earlier one.
// docs/theory/preconditioner.md has the equations and the measurements.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "async_factor.h"
#include "factor.h"
#include "pcg.h"
#include "recent_solutions.h"
#include "sutura/component.h"
#include "tissue_solver.h"

namespace sutura::tissue {

/// Step at which a factor was adopted, and the step of its snapshot.
struct Adoption {
  Index step, snapshot;
  bool operator==(const Adoption&) const = default;
};

struct AsyncOptions {
  FactorBackend backend = default_backend();
  Real tolerance = 1e-4;       ///< |b - A x| / |b|
  Index max_iterations = 200;  ///< then the matrix of the step is factorised at once
  /// -1: a factor is adopted in the first step that finds it ready. k >= 0: exactly k steps after
  /// its snapshot, waiting for it if need be, so that a run can be repeated bit by bit.
  Index lag = -1;
  /// Not empty: snapshots and adoptions happen exactly as in this log of an earlier run with lag -1
  /// (AsyncSolver::adoptions), whose results are then repeated bit by bit.
  std::vector<Adoption> replay;
  Index refactor_iterations = 2;  ///< a step that needed more asks for a new factor
  Index max_age =
      200;  ///< steps; at three quarters of it a factor is replaced anyway, past it it is stale
  /// With fixed adoptions: how long to wait for the worker (s) before factorising its snapshot
  /// here. The result is the same.
  Real patience = 10;
  Resources resources;      ///< whose workers make the factors, and where plans may be found
  FactorWorker::Hook hook;  ///< for tests
};

class AsyncSolver : public TissueSolver {
 public:
  explicit AsyncSolver(AsyncOptions options = {}) : options_(std::move(options)) {}
  ~AsyncSolver() override;
  void set_options(AsyncOptions options) { options_ = std::move(options); }
  const AsyncOptions& options() const { return options_; }
  /// Single right-hand sides are solved there from now on; null: here.
  void set_device(ConjugateGradientDevice* device) { device_ = device; }

  void analyse(std::shared_ptr<const NodePattern> pattern, std::span<const char> fixed,
               std::span<const Index> candidates) override;
  bool wants_rotations() const override { return true; }
  void prepare(const NodeMatrix& A, std::span<const Mat3> rotations, Index step,
               bool same = false) override;
  void renew() override { renew_ = true; }
  void solve(Eigen::Ref<MatX> columns, Real enough = 0) override;
  void solve_as_compliance(Eigen::Ref<MatX> columns) override;
  ConjugateGradientDevice* device() override { return device_; }
  Index nodes() const override { return pattern_->nodes(); }
  bool is_fixed(Index node) const override {
    return !fixed_.empty() && fixed_[static_cast<std::size_t>(node)];
  }
  Index touch(std::span<const Index> nodes) override;
  NodeCompliance compliance() const override;
  bool add_on_device(const SparseRows& rows, Real scale, Eigen::Ref<MatX> W) override;
  const TissueSolveReport& report() const override { return report_; }

  void archive(Archive& archive) override;
  const std::vector<Adoption>& adoptions() const { return adoptions_; }

 private:
  void archive_job(Archive& archive, std::shared_ptr<Snapshot>& snapshot);
  void submit(std::unique_ptr<SnapshotFactor> job);
  std::unique_ptr<SnapshotFactor> take_snapshot();
  void adopt(std::unique_ptr<SnapshotFactor> fresh);
  void adopt_what_is_due();
  bool factorise_here();
  bool wants_new_factor() const;
  bool adoption_is_fixed() const { return options_.lag >= 0 || !options_.replay.empty(); }
  bool is_due() const;
  /// Single precision turns 1e-6 of the residual of a perfect factor into noise: too much where
  /// more digits are asked for, nothing for the usual tolerances.
  bool rough() const { return options_.tolerance >= 1e-5; }
  const Preconditioner& preconditioner();
  void entries_of_inverse(std::span<const Index> rows, std::span<const Index> columns,
                          Eigen::Ref<MatX> entries);
  bool give_to_device(bool same_matrix);
  bool solve_on_device(Real tolerance);

  AsyncOptions options_;
  std::shared_ptr<const NodePattern> pattern_;
  std::shared_ptr<const FactorPlan> plan_;
  std::vector<char> fixed_;
  Candidates candidates_;

  const NodeMatrix* A_ = nullptr;
  std::vector<Mat3> rotations_;
  Index step_ = 0;

  std::unique_ptr<SnapshotFactor> current_;    ///< in use; null until one succeeds
  std::unique_ptr<SnapshotFactor> spare_;      ///< memory of the one before
  std::shared_ptr<Snapshot> in_flight_;        ///< handed to the worker, not adopted yet
  bool worker_lost_ = false;                   ///< it never answered: factorise here from now on
  std::unique_ptr<SnapshotFactor> postponed_;  ///< what the lost worker would have been given
  std::unique_ptr<FactorWorker> worker_;

  ConjugateGradientDevice* device_ = nullptr;
  bool on_device_ = false;                 ///< matrix and factor of this step are there
  const Factor* device_factor_ = nullptr;  ///< the one that is there
  Index device_snapshot_ = -1;
  bool recent_on_device_ = false;  ///< it has kept what recent_ has
  Index compliance_id_ = 0;        ///< another one for every factor in use
  Pcg pcg_;
  RecentSolutions recent_;
  WarpedFactor warped_;
  BlockJacobi jacobi_;
  bool jacobi_ready_ = false;
  GrowingMat x_, single_x_, columns_;
  VecX asked_, answered_;  ///< the last single right-hand side of the step and its solution
  Index last_iterations_ = 0;
  std::vector<Adoption> adoptions_;
  TissueSolveReport report_;
  bool renew_ = false;  ///< factorise the next matrix at once
};

}  // namespace sutura::tissue
