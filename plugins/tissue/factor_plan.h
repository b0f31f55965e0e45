// The plan of a factorisation: elimination order and the route of every entry. Internal to the
// backends.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "factor.h"

namespace sutura::tissue {

class FactorPlan {
 public:
  FactorPlan(std::shared_ptr<const NodePattern> pattern, std::span<const char> fixed,
             std::span<const Index> candidates, FactorBackend backend);
  FactorPlan(const FactorPlan& other, std::span<const Index> candidates);

  FactorBackend backend = FactorBackend::eigen;
  std::shared_ptr<const NodePattern> pattern;
  std::vector<std::int32_t> base;   ///< free nodes in fill-reducing order, candidates too
  std::vector<std::int32_t> order;  ///< free nodes, in elimination order
  std::vector<Index> candidates;    ///< the last ones of `order`
  /// Lower triangle of the reordered matrix by columns: row indices, and where in
  /// NodeMatrix::values each entry comes from (-1: a zero kept for the structure).
  std::vector<std::int32_t> column_start;
  std::vector<std::int32_t> row;
  std::vector<std::int32_t> source;

  Index size() const { return 3 * static_cast<Index>(order.size()); }
  /// Fills the entries; false if one is not finite.
  bool gather(const NodeMatrix& A, Real* entries) const;
  /// Rows of free nodes, in elimination order.
  void restrict_to_free(const Eigen::Ref<const MatX>& full, Eigen::Ref<MatX> reduced) const;
  /// The reverse; rows of fixed nodes become zero.
  void extend(const Eigen::Ref<const MatX>& reduced, Eigen::Ref<MatX> full) const;

 private:
  void put_last(std::span<const Index> candidates);
};

#ifdef SUTURA_WITH_CHOLMOD
std::unique_ptr<Factor> make_cholmod_factor(std::shared_ptr<const FactorPlan> plan);
#endif
std::unique_ptr<Factor> make_eigen_factor(std::shared_ptr<const FactorPlan> plan);

/// Nested dissection or minimum degree of a graph given by adjacency lists; position -> vertex.
std::vector<std::int32_t> fill_reducing_order(const std::vector<std::int32_t>& start,
                                              const std::vector<std::int32_t>& neighbour);

}  // namespace sutura::tissue
