// The compliance of a tissue seen by constraints: W = h^2 H A^-1 H^T.
//
// Nodes that are touched are eliminated last, so the last Schur block of the factor is the inverse
// of their compliance C, and C comes with the factor, made by the worker. W is then H Q C Q^T H^T,
// with Q the rotation of the material since the factor was made: no solve in the step. Nodes
// outside are solved for until the next factor includes them.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "block_matrix.h"
#include "sutura/body.h"
#include "sutura/types.h"

namespace sutura::tissue {

class TissueSolver;

/// A^-1 between the nodes that are known: A^-1(i, j) ~ Q_i C(i, j) Q_j^T.
struct NodeCompliance {
  using Matrix = Eigen::Map<const MatX, 0, Eigen::OuterStride<>>;
  /// Three rows and columns per known node, in the axes of the factor (m/N).
  Matrix C{nullptr, 0, 0, Eigen::OuterStride<>(1)};
  std::span<const Index> number;    ///< per node: its place in C; -1: not known
  std::span<const Mat3> then, now;  ///< rotations per node, Q = now then^T; empty: the identity

  /// C is the upper left corner of `all`.
  void see(const MatX& all, Index size) {
    new (&C) Matrix(all.data(), size, size, Eigen::OuterStride<>(all.rows()));
  }
  Mat3 turn(Index node) const {
    const auto i = static_cast<std::size_t>(node);
    return now.empty() ? Mat3(Mat3::Identity()) : Mat3(now[i] * then[i].transpose());
  }
  bool is_known(Index node) const {
    return C.size() > 0 && number[static_cast<std::size_t>(node)] >= 0;
  }
};

/// Which nodes to eliminate last: those touched lately and their neighbours.
class Candidates {
 public:
  static constexpr Index memory = 50;  ///< steps for which a touch is remembered
  static constexpr Index limit = 400;  ///< C of 400 nodes is 11 MB and takes 40 ms of the worker

  void reset(std::shared_ptr<const NodePattern> pattern, std::span<const char> fixed,
             std::span<const Index> from_the_start);
  void touch(std::span<const Index> nodes, Index step);
  /// True if a free node was touched that is not in `chosen`, and there is room for it.
  bool outgrown() const { return outgrown_; }
  const std::vector<Index>& chosen() const { return chosen_; }
  void archive(Archive& archive);
  /// Chooses anew: touched nodes first, the latest before the others, then their neighbours.
  void choose(Index step);

 private:
  std::shared_ptr<const NodePattern> pattern_;
  std::vector<char> fixed_;
  std::vector<char> is_chosen_;
  std::vector<char> is_touched_;  ///< while choosing
  std::vector<Index> chosen_;
  std::vector<Index> touched_at_;  ///< per node, step of the last touch
  bool outgrown_ = false;
  Index full_until_ = -1;  ///< step; before it a new choice could not hold more touched nodes
};

/// W += h^2 H A^-1 H^T over the rows of one body. Returns the number of columns that had to be
/// solved for because rows touch nodes outside the candidates.
Index add_tissue_compliance(TissueSolver& solver, const BodyRows& rows, Real dt,
                            Eigen::Ref<MatX> W);

}  // namespace sutura::tissue
