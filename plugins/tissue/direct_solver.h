// Factorises the matrix of every step: exact, simple, and the reference for the asynchronous
// solver.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "factor.h"
#include "pcg.h"
#include "tissue_solver.h"

namespace sutura::tissue {

class SynchronousSolver : public TissueSolver {
 public:
  explicit SynchronousSolver(FactorBackend backend = default_backend()) : backend_(backend) {}
  void set_backend(FactorBackend backend) { backend_ = backend; }
  /// Where plans of elimination may be found.
  void set_cache(std::shared_ptr<Cache> cache) { cache_ = std::move(cache); }

  void analyse(std::shared_ptr<const NodePattern> pattern, std::span<const char> fixed,
               std::span<const Index> candidates) override;
  bool wants_rotations() const override { return false; }
  void prepare(const NodeMatrix& A, std::span<const Mat3> rotations, Index step,
               bool same = false) override;
  void solve(Eigen::Ref<MatX> columns, Real enough = 0) override;
  void solve_as_compliance(Eigen::Ref<MatX> columns) override { solve(columns); }
  Index nodes() const override { return static_cast<Index>(number_.size()); }
  bool is_fixed(Index node) const override {
    return !fixed_.empty() && fixed_[static_cast<std::size_t>(node)];
  }
  Index touch(std::span<const Index> nodes) override {
    candidates_.touch(nodes, step_);
    return 0;
  }
  NodeCompliance compliance() const override;
  const TissueSolveReport& report() const override { return report_; }
  void archive(Archive& archive) override;

 private:
  void adopt_plan();

  FactorBackend backend_;
  std::shared_ptr<Cache> cache_;
  std::shared_ptr<const FactorPlan> plan_;
  std::unique_ptr<Factor> factor_;
  std::vector<char> fixed_;
  Candidates candidates_;
  std::vector<Index> number_;  ///< per node, among the candidates; -1
  Index step_ = 0;
  const NodeMatrix* A_ = nullptr;
  bool ok_ = false;
  mutable MatX compliance_;  ///< inverted when first asked for in a step
  mutable bool has_compliance_ = false;
  GrowingMat x_;
  VecX in_, out_;
  Pcg pcg_;
  TissueSolveReport report_;
};

}  // namespace sutura::tissue
