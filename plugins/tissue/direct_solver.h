// Factorises the matrix of every step: exact, reproducible, and slow beyond a few thousand nodes.
#pragma once

#include <memory>

#include "factor.h"
#include "tissue_solver.h"

namespace sutura {

class DirectSolver : public TissueSolver {
 public:
  explicit DirectSolver(FactorBackend backend = default_backend()) : backend_(backend) {}

  void analyse(std::shared_ptr<const NodePattern> pattern, std::span<const char> fixed,
               std::span<const Index> candidates) override;
  bool wants_rotations() const override { return false; }
  void prepare(const NodeMatrix& A, std::span<const Mat3> rotations, Index step) override;
  /// If the matrix could not be factorised, the columns become zero: the tissue coasts for a step,
  /// and the report says so.
  void solve(Eigen::Ref<MatX> columns) override;
  bool has_compliance(std::span<const Index> nodes) const override;
  Mat3 compliance_block(Index i, Index j) const override;
  const TissueSolveReport& report() const override { return report_; }

 private:
  FactorBackend backend_;
  std::shared_ptr<const FactorPlan> plan_;
  std::unique_ptr<Factor> factor_;
  bool usable_ = false;
  std::vector<Index> place_;  ///< per node: place among the tail nodes, -1 if not there
  std::vector<char> fixed_;
  mutable MatX tail_;  ///< of this step, made when first asked for
  mutable bool tail_current_ = false;
  TissueSolveReport report_;
};

std::unique_ptr<TissueSolver> make_direct_solver();

}  // namespace sutura
