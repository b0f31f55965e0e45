// Conjugate gradients on an OpenCL device: the kernels of gradients.cl and solves.cl, and what they
// need.
#pragma once

#include <optional>
#include <vector>

#include "contact_compliance.h"
#include "elements.h"
#include "panels.h"

namespace sutura::opencl {

/// (L L^T)^-1 on the device, in the order of the factor.
class Solves {
 public:
  Solves(const Device& device, Precision precision)
      : device_(device), precision_(precision), real_(size_of_sum(precision)) {}
  void set_factor(const SupernodalFactor& factor);
  Index unknowns() const { return size_; }
  /// x <- (L L^T)^-1 b, unless *done.
  void solve(const Numbers& b, const Numbers& x, const Buffer& done) {
    forward_small(b, x, done);
    finish(b, x, done);
  }
  /// The same in two parts: the small subtrees on the way forward, and the rest.
  void forward_small(const Numbers& b, const Numbers& x, const Buffer& done) {
    forward_small({b, below_, y_, x, done, 1});
  }
  void finish(const Numbers& b, const Numbers& x, const Buffer& done) {
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
  /// Right-hand sides, what panels leave of each, y, x.
  struct Sides {
    const Numbers &b, &below, &y, &x;
    const Buffer& done;
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
  std::size_t real_;  ///< bytes
  Index size_ = 0;
  Schedule schedule_;
  std::vector<std::int32_t> first_column_, row_, row_of_;  // the pattern that `schedule_` is for
  bool rough_ = false;  ///< what the program was made for: a factor in single precision
  std::optional<Program> program_;
  Buffer panels_{device_}, gather_{device_}, gather_more_{device_}, rows_{device_},
      subtree_start_{device_}, subtree_{device_}, row_tasks_{device_}, column_tasks_{device_},
      triangle_tasks_{device_}, multiply_tasks_{device_}, value_{device_}, z_{device_},
      not_done_{device_}, positions_{device_}, rows_wanted_{device_};
  Numbers below_{device_, real_}, y_{device_, real_}, many_b_{device_, real_},
      many_below_{device_, real_}, many_y_{device_, real_}, many_x_{device_, real_},
      picked_{device_, real_};
  std::vector<Real> host_picked_;
};

/// As in gradients.cl, where its numbers are `real`.
struct GradientStatus {
  cl_int done = 0, iterations = 0, failed = 0, unused = 0;
  union {
    double exact[2] = {};  // size, residual
    float rounded[2];
  };
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
  void keep(const Eigen::Ref<const MatX>& x, Index next);
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
  static constexpr int most_kept = static_cast<int>(ConjugateGradientDevice::most_recent);
  /// The status: nothing is done yet. x <- the combination of the kept ones, r <- b - A x.
  GradientStatus* start(const Eigen::Ref<const VecX>& b);
  void keep_answer(const Eigen::Ref<const VecX>& x);
  void set_pattern(const NodeMatrixView& A, std::span<const char> fixed);
  /// z <- P^-1 r, rz <- r . z.
  void precondition(const Numbers& rz);
  void begin_preconditioning();
  void finish_preconditioning(const Numbers& rz);

  const Device& device_;
  std::size_t real_, entry_;  ///< bytes
  Solves solves_;
  Elements elements_;
  ContactCompliance contacts_;
  Program program_;
  int nodes_ = 0;
  std::vector<std::int32_t> row_start_, column_;  // the pattern on the device
  std::vector<char> fixed_;
  std::vector<std::int32_t> known_position_, entry_rows_, entry_columns_;
  Buffer full_start_{device_}, entries_{device_}, columns_{device_}, is_fixed_{device_},
      row_of_{device_}, position_{device_}, status_{device_};
  Numbers values_{device_, entry_}, then_{device_, real_}, turns_{device_, real_};
  Numbers b_{device_, real_}, x_{device_, real_}, r_{device_, real_}, z_{device_, real_},
      p_{device_, real_}, q_{device_, real_}, factor_b_{device_, real_}, factor_x_{device_, real_};
  Numbers size2_{device_, real_}, residual2_{device_, real_},
      rz_[2]{{device_, real_}, {device_, real_}}, pq_{device_, real_};
  // Solutions that are kept, by columns, and their products with A.
  Numbers kept_{device_, real_}, products_{device_, real_}, kept_sums_{device_, real_},
      weights_{device_, real_};
  int kept_count_ = 0, next_kept_ = 0;
  static constexpr int all_unknown = (1 << most_kept) - 1;
  int unknown_products_ = all_unknown;  ///< a bit per column
  bool then_is_there_ = false;          ///< rotations of the factor
  Pinned statuses_;                     // two: the last one, and how an iteration begins
};

}  // namespace sutura::opencl
