// Conjugate gradients on an OpenCL device: the kernels of gradients.cl and solves.cl, and what they
// need.
#pragma once

#include <memory>
#include <vector>

#include "contact_compliance.h"
#include "device.h"
#include "elements.h"
#include "panels.h"
#include "precision.h"

namespace sutura::opencl {

/// (L L^T)^-1 on the device, in the order of the factor.
class Solves {
 public:
  Solves(const Device& device, Precision precision);
  ~Solves();
  void set_factor(const SupernodalFactor& factor);
  Index unknowns() const { return size_; }
  /// x <- (L L^T)^-1 b, unless *done.
  void solve(const Buffer& b, const Buffer& x, const Buffer& done) {
    forward_small(b, x, done);
    finish(b, x, done);
  }
  /// The same in two parts: the small subtrees on the way forward, and the rest.
  void forward_small(const Buffer& b, const Buffer& x, const Buffer& done) {
    forward_small({b, below_, y_, x, done, 1});
  }
  void finish(const Buffer& b, const Buffer& x, const Buffer& done) {
    finish({b, below_, y_, x, done, 1});
  }
  static constexpr int most_columns = 32;  ///< that memory is taken for
  /// entries <- those of (L L^T)^-1 at `rows` of at most `most_columns` columns, by columns.
  /// Positions in the factor; -1: zero. Waits.
  void entries_of_inverse(const std::vector<std::int32_t>& rows,
                          const std::vector<std::int32_t>& columns, Eigen::Ref<MatX> entries);
  const Schedule& schedule() const { return schedule_; }
  std::size_t launches() const { return 2 * (schedule_.tiers.size() + schedule_.levels.size()); }

 private:
  struct Program;
  /// Right-hand sides, what panels leave of each, y, x.
  struct Sides {
    const Buffer &b, &below, &y, &x, &done;
    cl_int count;
  };
  bool same_pattern(const SupernodalFactor& factor) const;
  void forward_small(const Sides& sides);
  void finish(const Sides& sides);
  cl_int size() const { return static_cast<cl_int>(size_); }
  /// Of what panels leave, and a zero.
  cl_int left() const { return static_cast<cl_int>(schedule_.below_size + 2); }
  static std::size_t groups(const Schedule::Range& tasks, const Sides& sides) {
    return static_cast<std::size_t>(tasks.count) * static_cast<std::size_t>(sides.count) * 256;
  }

  const Device& device_;
  Precision precision_;
  Index size_ = 0;
  Schedule schedule_;
  std::vector<std::int32_t> first_column_, row_, row_of_;  // the pattern that `schedule_` is for
  std::unique_ptr<Program> program_;
  Buffer panels_, gather_, gather_more_, rows_, subtree_start_, subtree_, row_tasks_, column_tasks_,
      triangle_tasks_, multiply_tasks_, value_, z_, below_, y_, not_done_, many_[4], positions_,
      rows_wanted_, picked_;
  std::vector<double> doubles_;
  std::vector<float> floats_;
};

/// As in gradients.cl.
template <class T>
struct GradientStatus {
  cl_int done = 0, iterations = 0, failed = 0, unused = 0;
  T size = 0, residual = 0;
};

class Gradients {
 public:
  Gradients(const Device& device, Precision precision);
  ~Gradients();

  void set_matrix(const NodeMatrixView& A, std::span<const char> fixed);
  /// As ConjugateGradientDevice has them.
  void set_elements(const TetElementsView& tets, const NodeMatrixView& pattern,
                    std::span<const char> fixed);
  void set_viscosity(const VecX& moved, Real share) { elements_.set_viscosity(moved, share); }
  void assemble(const VecX& moved, Real scale, const VecX& diagonal, VecX& force,
                std::vector<Mat3>& rotations);
  void element_force(const VecX& moved, VecX& force) { elements_.force(moved, force); }
  void read_matrix(std::span<Real> values);
  void set_factor(const SupernodalFactor& factor);
  void set_turns(std::span<const Mat3> turns);
  void find_turns(std::span<const Mat3> of_factor);
  ConjugateGradientDevice::Report solve(const Eigen::Ref<const VecX>& b, Eigen::Ref<VecX> x,
                                        Real tolerance, Index max_iterations);
  /// As ConjugateGradientDevice has it.
  void entries_of_inverse(std::span<const Index> rows, std::span<const Index> columns,
                          Eigen::Ref<MatX> entries);
  void add_compliance(const KnownCompliance& known, const SparseRows& rows, Real scale,
                      Eigen::Ref<MatX> W) {
    contacts_.add(known, rows, scale, W);
  }
  /// For benchmarks, after `begin`: one product with A, one application of P^-1; enqueued, not
  /// waited for.
  void begin(const Eigen::Ref<const VecX>& b);
  void product();
  void precondition() { precondition(rz_[0]); }
  const Solves& solves() const { return solves_; }

 private:
  struct Program;
  template <class T>
  ConjugateGradientDevice::Report solve_with(const Eigen::Ref<const VecX>& b, Eigen::Ref<VecX> x,
                                             Real tolerance, Index max_iterations);
  template <class T>
  void write_as(Buffer& to, const Real* from, std::size_t count);
  /// The status: nothing is done yet. x <- 0, r <- b.
  template <class T>
  GradientStatus<T>* start(const Eigen::Ref<const VecX>& b);
  void write_reals(Buffer& to, const Real* from, std::size_t count);
  void set_pattern(const NodeMatrixView& A, std::span<const char> fixed);
  /// z <- P^-1 r, rz <- r . z.
  void precondition(const Buffer& rz);
  void begin_preconditioning();
  void finish_preconditioning(const Buffer& rz);

  const Device& device_;
  Precision precision_;
  Solves solves_;
  Elements elements_;
  ContactCompliance contacts_;
  std::unique_ptr<Program> program_;
  int nodes_ = 0;
  std::vector<std::int32_t> row_start_, column_;  // the pattern on the device
  std::vector<char> fixed_;
  std::vector<std::int32_t> known_position_, entry_rows_, entry_columns_;
  Buffer full_start_, entries_, columns_, is_fixed_, values_, then_, turns_, row_of_, position_;
  Buffer b_, x_, r_, z_, p_, q_, factor_b_, factor_x_, size2_, residual2_, rz_[2], pq_, status_;
  bool then_is_there_ = false;  ///< rotations of the factor
  std::vector<float> rounded_;
  Pinned statuses_;  // two: the last one, and how an iteration begins
};

}  // namespace sutura::opencl
