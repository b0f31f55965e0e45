// The compliance of a factor's candidates, and of nodes that were touched after those were chosen.
//
// C of the candidates comes with the factor. A node that is touched before the next factor includes
// it gets its three columns by solving, once for this factor, whatever the number of passes, steps
// and rows that then ask for it.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "compliance.h"
#include "factor.h"

namespace sutura::tissue {

/// Nodes beyond the candidates, in the portions in which they were learnt: learnt like that again
/// they have the same bits.
struct LearntNodes {
  std::vector<Index> node, end;  ///< `end`: of each portion
  void archive(Archive& archive, Index nodes);
};

class GrowingCompliance {
 public:
  static constexpr Index limit = 1200;  ///< nodes: C is 104 MB then
  static constexpr Index spare = 64;    ///< nodes beyond the candidates that there is room for
  static constexpr Index at_once = 10;  ///< nodes: their columns are one call of a device

  /// Of a new factor: what was known of the last one is forgotten, its memory kept.
  void begin(const Factor& factor, std::span<const Index> candidates, Index nodes);

  /// entries <- A^-1 between unknowns of the whole tissue (three per node): `rows` down, `columns`
  /// across.
  using Entries = std::function<void(std::span<const Index> rows, std::span<const Index> columns,
                                     Eigen::Ref<MatX> entries)>;
  /// Learns those of `nodes` that are neither fixed nor known, if there is room for all of them.
  /// Returns the number of columns that were solved for.
  Index learn(std::span<const Index> nodes, std::span<const char> fixed, const Entries& entries);

  /// Rotations per node, as NodeCompliance has them.
  NodeCompliance view(std::span<const Mat3> then, std::span<const Mat3> now) const;

  const LearntNodes& learnt() const { return learnt_; }
  /// The next `learn` begins with these, in the same portions, so that a run that goes on from a
  /// state has the same bits.
  void learn_again(LearntNodes learnt);

 private:
  Index add(std::span<const Index> nodes, const Entries& entries);
  void make_room(Index nodes);

  MatX C_;                       ///< may be larger than what is known
  Index known_ = 0;              ///< nodes
  std::vector<Index> number_;    ///< per node: its place in C; -1: not known
  std::vector<Index> unknowns_;  ///< three per known node, in the order of C
  LearntNodes learnt_;
  std::size_t portions_ = 0;  ///< of `learnt_`, that are in C
  std::vector<Index> missing_;
  GrowingMat entries_;
};

}  // namespace sutura::tissue
