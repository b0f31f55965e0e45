// Preconditioned conjugate gradients on the matrix of a tissue, several right-hand sides at a time.
//
// The iteration always runs on the true matrix: a poor preconditioner costs iterations, never
// accuracy.
#pragma once

#include <span>
#include <vector>

#include "block_matrix.h"
#include "factor.h"
#include "sutura/growing.h"

namespace sutura::tissue {

class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  /// z <- P^-1 r, in place, one or more columns; symmetric positive definite; rows of fixed nodes
  /// of the result are zero.
  virtual void apply(Eigen::Ref<MatX> columns) const = 0;
};

/// The 3x3 diagonal blocks of A: the last resort when no factor exists.
class BlockJacobi : public Preconditioner {
 public:
  void compute(const NodeMatrix& A, std::span<const char> fixed);
  void apply(Eigen::Ref<MatX> columns) const override;

 private:
  std::vector<Mat3> inverse_;  ///< per node; zero for fixed ones
};

/// P^-1 = Q F0^-1 Q^T: the factor of an earlier matrix, turned with the material around each node.
/// Q_i = R_i(now) R_i(then)^T. A body that only rotated since then is preconditioned exactly.
class WarpedFactor : public Preconditioner {
 public:
  /// `rough`: by Factor::solve_roughly. All are kept by reference.
  void set(const Factor& factor, std::span<const Mat3> then, std::span<const Mat3> now,
           bool rough = false);
  void apply(Eigen::Ref<MatX> columns) const override;
  std::span<const Mat3> turns() const;

 private:
  const Factor* factor_ = nullptr;
  bool rough_ = false;
  std::span<const Mat3> then_, now_;
  mutable std::vector<Mat3> turn_;       ///< Q_i
  mutable bool turns_are_known_ = true;  ///< they are found when somebody asks
};

struct PcgReport {
  Index iterations = 0;  ///< of the slowest column; one product with A and one with P^-1 each
  Real residual = 0;     ///< |b - A x| / |b|, of the worst column
  bool converged = true;
};

class Pcg {
 public:
  /// Room for one right-hand side of size n.
  void reserve(Index n);
  /// x <- A^-1 b within |b - A x| <= tolerance |b| per column, starting from x if `start_from_x`,
  /// else from zero. Rows of fixed nodes of b are ignored, those of x end as zero. Stops early, not
  /// converged, when A or P turns out not to be positive definite or not finite.
  PcgReport solve(const NodeMatrix& A, std::span<const char> fixed, const Preconditioner& P,
                  const Eigen::Ref<const MatX>& b, GrowingMat& x, Real tolerance,
                  Index max_iterations, bool start_from_x = false);

 private:
  void drop(Index column, Index& active);
  GrowingMat r_, z_, p_;
  GrowingVec rz_, norm_b_;
  VecX in_, out_;
  std::vector<Index> column_;  ///< which column of x each active one is
};

/// Zeroes the rows of fixed nodes.
void clear_fixed(std::span<const char> fixed, Eigen::Ref<MatX> columns);

}  // namespace sutura::tissue
