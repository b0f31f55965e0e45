// Eigen's simplicial Cholesky: MPL 2, no other library needed, several times slower than CHOLMOD.
#include <Eigen/SparseCholesky>
#include <cassert>

#include "dense_inverse.h"
#include "factor_plan.h"

namespace sutura::tissue {
namespace {

class EigenFactor : public Factor {
 public:
  explicit EigenFactor(std::shared_ptr<const FactorPlan> plan)
      : plan_(std::move(plan)), A_(plan_->size(), plan_->size()) {
    A_.resizeNonZeros(static_cast<Index>(plan_->row.size()));
    std::copy(plan_->row.begin(), plan_->row.end(), A_.innerIndexPtr());
    std::copy(plan_->column_start.begin(), plan_->column_start.end(), A_.outerIndexPtr());
    std::fill(A_.valuePtr(), A_.valuePtr() + plan_->row.size(), 1.0);
    if (plan_->size() > 0) cholesky_.analyzePattern(A_);
  }

  bool factorise(const NodeMatrix& A) override {
    ready_ = plan_->gather(A, A_.valuePtr());
    if (ready_ && plan_->size() > 0) {
      cholesky_.factorize(A_);
      ready_ = cholesky_.info() == Eigen::Success;
    }
    return ready_;
  }

  void solve(Eigen::Ref<MatX> columns) const override {
    assert(ready_);
    work_.resize(plan_->size(), columns.cols());
    plan_->restrict_to_free(columns, work_);
    if (plan_->size() > 0) {
      cholesky_.matrixL().solveInPlace(work_);
      cholesky_.matrixU().solveInPlace(work_);
    }
    plan_->extend(work_, columns);
  }

  void candidate_compliance(MatX& C) const override {
    const Index size = ready_ ? 3 * static_cast<Index>(plan_->candidates.size()) : 0;
    const auto& L = cholesky_.matrixL().nestedExpression();
    const Index first = plan_->size() - size;
    lower_.setZero(size, size);
    for (Index c = 0; c < size; ++c)
      for (Eigen::SparseMatrix<Real>::InnerIterator it(L, first + c); it; ++it)
        lower_(it.row() - first, c) = it.value();
    if (C.rows() < size) C.resize(size, size);
    invert_.compute(lower_, inverse_);
    C.topLeftCorner(size, size) = inverse_;
  }

 private:
  std::shared_ptr<const FactorPlan> plan_;
  Eigen::SparseMatrix<Real> A_;  ///< lower triangle, in elimination order
  Eigen::SimplicialLLT<Eigen::SparseMatrix<Real>, Eigen::Lower, Eigen::NaturalOrdering<int>>
      cholesky_;
  bool ready_ = false;
  mutable GrowingMat work_;
  mutable MatX lower_, inverse_;
  mutable DenseInverse invert_;
};

}  // namespace

std::unique_ptr<Factor> make_eigen_factor(std::shared_ptr<const FactorPlan> plan) {
  return std::make_unique<EigenFactor>(std::move(plan));
}

}  // namespace sutura::tissue
