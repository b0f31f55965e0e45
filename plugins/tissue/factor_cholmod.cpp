// CHOLMOD's supernodal Cholesky (GPL module) on whatever BLAS it is linked with.
#ifdef SUTURA_WITH_CHOLMOD

#include <cholmod.h>
#include <pthread.h>

#include <cassert>
#include <mutex>

#include "dense_inverse.h"
#include "factor_plan.h"

// OpenBLAS would start workers of its own for every dense block: slower on blocks of this size, and
// they would compete with the simulation. Other BLAS libraries do not have the symbols.
extern "C" void openblas_set_num_threads(int) __attribute__((weak));
extern "C" int openblas_get_num_threads() __attribute__((weak));
// CHOLMOD may itself be built with OpenMP, four threads per dense block whatever the machine.
extern "C" int omp_get_max_active_levels() __attribute__((weak));
extern "C" void omp_set_max_active_levels(int) __attribute__((weak));

namespace sutura::tissue {
namespace {

/// No parallel region opens while this lives; a setting of the calling worker, put back after.
class WithoutOpenMP {
 public:
  WithoutOpenMP() {
    if (!omp_get_max_active_levels || !omp_set_max_active_levels) return;
    levels_ = omp_get_max_active_levels();
    omp_set_max_active_levels(0);
  }
  ~WithoutOpenMP() {
    if (levels_ >= 0) omp_set_max_active_levels(levels_);
  }
  WithoutOpenMP(const WithoutOpenMP&) = delete;
  WithoutOpenMP& operator=(const WithoutOpenMP&) = delete;

 private:
  int levels_ = -1;
};

/// OpenBLAS works on one thread while any of these lives, whichever workers they live on; the last
/// one puts back what the host had set. 4 ns each (measured).
class OneBlasThread {
 public:
  OneBlasThread() {
    if (!openblas_set_num_threads || !openblas_get_num_threads) return;
    // OpenBLAS takes its time to start and end workers. A process that forked meanwhile on another
    // worker would leave the lock held in its child, for ever.
    [[maybe_unused]] static const int watched =
        ::pthread_atfork([] { mutex_.lock(); }, [] { mutex_.unlock(); }, in_child);
    const std::lock_guard lock(mutex_);
    if (alive_++ > 0) return;
    if (!interrupted_) threads_ = openblas_get_num_threads();
    interrupted_ = false;
    openblas_set_num_threads(1);
  }
  ~OneBlasThread() {
    if (!openblas_set_num_threads || !openblas_get_num_threads) return;
    const std::lock_guard lock(mutex_);
    // Unless the host has set another number meanwhile.
    if (--alive_ == 0 && openblas_get_num_threads() == 1) openblas_set_num_threads(threads_);
  }
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;

 private:
  /// Those of other workers do not come along.
  static void in_child() {
    interrupted_ = interrupted_ || alive_ > 0;
    alive_ = 0;
    mutex_.unlock();
  }

  inline static std::mutex mutex_;
  inline static int alive_ = 0, threads_ = 1;
  inline static bool interrupted_ = false;  ///< nobody has put back what the host had set
};

/// What every call of CHOLMOD is made under.
struct QuietLibraries {
  OneBlasThread blas;
  WithoutOpenMP openmp;
};

class CholmodFactor : public Factor {
 public:
  explicit CholmodFactor(std::shared_ptr<const FactorPlan> plan)
      : plan_(std::move(plan)), entries_(plan_->row.size(), 1.0) {
    cholmod_start(&common_);
    common_.print = 0;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.quick_return_if_not_posdef = 1;
    common_.nmethods = 1;  // the plan has ordered the matrix; only the tree is postordered
    common_.method[0].ordering = CHOLMOD_NATURAL;
    common_.postorder = 1;

    const auto n = static_cast<std::size_t>(plan_->size());
    A_.nrow = A_.ncol = n;
    A_.nzmax = plan_->row.size();
    A_.p = const_cast<std::int32_t*>(plan_->column_start.data());  // read only for CHOLMOD
    A_.i = const_cast<std::int32_t*>(plan_->row.data());
    A_.x = entries_.data();
    A_.stype = -1;
    A_.itype = CHOLMOD_INT;
    A_.xtype = CHOLMOD_REAL;
    A_.dtype = CHOLMOD_DOUBLE;
    A_.sorted = 1;
    A_.packed = 1;
    if (n > 0) L_ = cholmod_analyze(&A_, &common_);
    work_.resize(plan_->size(), columns_at_once);
  }

  ~CholmodFactor() override {
    cholmod_free_dense(&x_, &common_);
    cholmod_free_dense(&y_, &common_);
    cholmod_free_dense(&e_, &common_);
    cholmod_free_factor(&L_, &common_);
    cholmod_finish(&common_);
  }

  bool factorise(const NodeMatrix& A) override {
    ready_ = plan_->gather(A, entries_.data());
    if (!ready_ || plan_->size() == 0) return ready_;
    const QuietLibraries guard;
    // Out of memory and "not positive definite" are both reported here; L_ is null only if the
    // analysis ran out of memory.
    ready_ = L_ != nullptr && cholmod_factorize(&A_, L_, &common_) != 0 &&
             common_.status == CHOLMOD_OK && L_->minor == L_->n;
    if (ready_ && keep_rough_) copy_rough();
    return ready_;
  }

  bool supernodes(SupernodalFactor& out) const override {
    if (!ready_ || L_ == nullptr) return false;
    const auto part = [](const void* numbers, std::size_t count) {
      return std::span(static_cast<const std::int32_t*>(numbers), count);
    };
    out.size = static_cast<Index>(L_->n);
    out.first_column = part(L_->super, L_->nsuper + 1);
    out.first_row = part(L_->pi, L_->nsuper + 1);
    out.first_value = part(L_->px, L_->nsuper + 1);
    out.row = part(L_->s, L_->ssize);
    out.value = std::span(static_cast<const Real*>(L_->x), L_->xsize);
    out.rough = rough_L_;
    out.row_of = rows_of_positions();
    return true;
  }

  void keep_rough() override { keep_rough_ = true; }

  void solve_roughly(Eigen::Ref<MatX> columns) const override {
    assert(ready_);
    // From four columns on, the blocked solve of CHOLMOD reads L often enough less.
    if (!keep_rough_ || columns.cols() > 3 || plan_->size() == 0) return solve(columns);
    for (Index c = 0; c < columns.cols(); ++c) {
      auto column = columns.col(c);
      const Real scale = column.cwiseAbs().maxCoeff();  // keeps single precision in its range
      if (!(scale > 0)) {
        column.setZero();
        continue;
      }
      for (std::size_t k = 0; k < row_of_.size(); ++k)
        rough_x_[static_cast<Index>(k)] = static_cast<float>(column[row_of_[k]] / scale);
      solve_rough_x();
      column.setZero();
      for (std::size_t k = 0; k < row_of_.size(); ++k)
        column[row_of_[k]] = scale * static_cast<Real>(rough_x_[static_cast<Index>(k)]);
    }
  }

  void solve(Eigen::Ref<MatX> columns) const override {
    assert(ready_);
    work_.resize(plan_->size(), columns.cols());
    plan_->restrict_to_free(columns, work_);
    if (plan_->size() == 0) {
      columns.setZero();
      return;
    }
    const QuietLibraries guard;
    cholmod_dense b{};
    b.nrow = static_cast<std::size_t>(work_.rows());
    b.ncol = static_cast<std::size_t>(work_.cols());
    b.nzmax = b.nrow * b.ncol;
    b.d = b.nrow;
    b.x = work_.data();
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    cholmod_solve2(CHOLMOD_A, L_, &b, nullptr, &x_, nullptr, &y_, &e_, &common_);
    plan_->extend(
        Eigen::Map<const MatX>(static_cast<const Real*>(x_->x), work_.rows(), work_.cols()),
        columns);
  }

  void candidate_compliance(MatX& C) const override {
    const Index size = ready_ ? 3 * static_cast<Index>(plan_->candidates.size()) : 0;
    if (C.rows() < size) C.resize(size, size);
    if (size == 0) return;
    // Supernode s holds columns super[s] .. super[s+1] of L; its rows are s[pi[s]] .. , its numbers
    // are dense from px[s], leading dimension the number of rows.
    const Index first = plan_->size() - size;
    const auto* super = static_cast<const int*>(L_->super);
    const auto* pi = static_cast<const int*>(L_->pi);
    const auto* px = static_cast<const int*>(L_->px);
    const auto* rows = static_cast<const int*>(L_->s);
    const auto* x = static_cast<const Real*>(L_->x);
    lower_.setZero(size, size);
    for (std::size_t s = 0; s < L_->nsuper; ++s) {
      const int height = pi[s + 1] - pi[s];
      for (int c = super[s]; c < super[s + 1]; ++c) {
        if (c < first) continue;
        for (int k = c - super[s]; k < height; ++k)
          lower_(rows[pi[s] + k] - first, c - first) =
              x[px[s] + k + static_cast<Index>(c - super[s]) * height];
      }
    }
    invert_.compute(lower_, inverse_);
    // CHOLMOD's own order of the candidates -> ours.
    const auto* perm = static_cast<const int*>(L_->Perm);
    for (Index c = 0; c < size; ++c)
      for (Index r = 0; r < size; ++r) {
        assert(perm[first + r] >= first);
        C(perm[first + r] - first, perm[first + c] - first) = inverse_(r, c);
      }
  }

 private:
  using Panel = Eigen::Map<const Eigen::MatrixXf, 0, Eigen::OuterStride<>>;

  std::vector<std::int32_t> rows_of_positions() const {
    const auto* perm = static_cast<const int*>(L_->Perm);
    std::vector<std::int32_t> out(L_->n);
    for (std::size_t k = 0; k < L_->n; ++k)
      out[k] = 3 * plan_->order[static_cast<std::size_t>(perm[k] / 3)] + perm[k] % 3;
    return out;
  }

  void copy_rough() {
    const auto* x = static_cast<const Real*>(L_->x);
    rough_L_.assign(x, x + L_->xsize);
    if (row_of_.size() == L_->n) return;
    row_of_ = rows_of_positions();
    rough_x_.resize(static_cast<Index>(L_->n));
    rough_below_.resize(static_cast<Index>(L_->maxesize));
  }

  /// rough_x_ <- (L L^T)^-1 rough_x_. Supernode s: columns first .. first + width of L, dense over
  /// its `height` rows, of which the first `width` are those columns themselves.
  void solve_rough_x() const {
    const auto* super = static_cast<const int*>(L_->super);
    const auto* pi = static_cast<const int*>(L_->pi);
    const auto* px = static_cast<const int*>(L_->px);
    const auto* rows = static_cast<const int*>(L_->s);
    const auto count = static_cast<int>(L_->nsuper);
    for (int s = 0; s < count; ++s) {
      const int first = super[s], width = super[s + 1] - first, height = pi[s + 1] - pi[s];
      const float* L = &rough_L_[static_cast<std::size_t>(px[s])];
      const Panel top(L, width, width, Eigen::OuterStride<>(height));
      auto x = rough_x_.segment(first, width);
      for (int j = 0; j < width; ++j) {
        x[j] /= top(j, j);
        x.tail(width - j - 1) -= x[j] * top.col(j).tail(width - j - 1);
      }
      if (height == width) continue;
      auto below = rough_below_.head(height - width);
      below.noalias() = Panel(L + width, height - width, width, Eigen::OuterStride<>(height)) * x;
      for (int i = width; i < height; ++i) rough_x_[rows[pi[s] + i]] -= below[i - width];
    }
    for (int s = count - 1; s >= 0; --s) {
      const int first = super[s], width = super[s + 1] - first, height = pi[s + 1] - pi[s];
      const float* L = &rough_L_[static_cast<std::size_t>(px[s])];
      const Panel top(L, width, width, Eigen::OuterStride<>(height));
      auto x = rough_x_.segment(first, width);
      if (height > width) {
        auto below = rough_below_.head(height - width);
        for (int i = width; i < height; ++i) below[i - width] = rough_x_[rows[pi[s] + i]];
        x.noalias() -=
            Panel(L + width, height - width, width, Eigen::OuterStride<>(height)).transpose() *
            below;
      }
      for (int j = width - 1; j >= 0; --j)
        x[j] = (x[j] - top.col(j).tail(width - j - 1).dot(x.tail(width - j - 1))) / top(j, j);
    }
  }

  std::shared_ptr<const FactorPlan> plan_;
  std::vector<Real> entries_;
  cholmod_sparse A_{};
  mutable cholmod_common common_{};
  cholmod_factor* L_ = nullptr;
  mutable cholmod_dense* x_ = nullptr;  // kept by cholmod_solve2 from call to call
  mutable cholmod_dense* y_ = nullptr;
  mutable cholmod_dense* e_ = nullptr;
  bool ready_ = false;
  mutable GrowingMat work_;
  mutable MatX lower_, inverse_;
  mutable DenseInverse invert_;
  bool keep_rough_ = false;
  std::vector<float> rough_L_;        ///< L_->x in single precision
  std::vector<std::int32_t> row_of_;  ///< position in L -> row of the full vector
  mutable Eigen::VectorXf rough_x_, rough_below_;
};

}  // namespace

std::unique_ptr<Factor> make_cholmod_factor(std::shared_ptr<const FactorPlan> plan) {
  return std::make_unique<CholmodFactor>(std::move(plan));
}

}  // namespace sutura::tissue

#endif
