#include "factor.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "factor_plan.h"
#include "sutura/cache.h"

namespace sutura::tissue {
namespace {

/// Adjacency lists of the vertices with `number` >= 0, by number.
void build_graph(const NodePattern& pattern, const std::vector<std::int32_t>& number,
                 std::size_t vertices, std::vector<std::int32_t>& start,
                 std::vector<std::int32_t>& neighbour) {
  start.assign(vertices + 1, 0);
  const auto each_edge = [&](auto&& visit) {
    for (Index i = 0; i < pattern.nodes(); ++i) {
      const std::int32_t a = number[static_cast<std::size_t>(i)];
      if (a < 0) continue;
      for (std::int32_t k = pattern.row_start()[static_cast<std::size_t>(i)] + 1;
           k < pattern.row_start()[static_cast<std::size_t>(i) + 1]; ++k) {
        const auto j = static_cast<std::size_t>(pattern.column()[static_cast<std::size_t>(k)]);
        if (number[j] >= 0) visit(static_cast<std::size_t>(a), static_cast<std::size_t>(number[j]));
      }
    }
  };
  each_edge([&](std::size_t a, std::size_t b) { ++start[a + 1], ++start[b + 1]; });
  for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
  neighbour.resize(static_cast<std::size_t>(start.back()));
  std::vector<std::int32_t> at(start.begin(), start.end() - 1);
  each_edge([&](std::size_t a, std::size_t b) {
    neighbour[static_cast<std::size_t>(at[a]++)] = static_cast<std::int32_t>(b);
    neighbour[static_cast<std::size_t>(at[b]++)] = static_cast<std::int32_t>(a);
  });
}

/// A block of the lower triangle, in elimination order.
struct Placed {
  std::int32_t row = 0;
  std::int32_t slot = -1;  ///< -1: structural zero
  bool transposed = false;
  bool operator<(const Placed& other) const { return row < other.row; }
};

}  // namespace

FactorPlan::FactorPlan(std::shared_ptr<const NodePattern> graph, std::span<const char> fixed,
                       std::span<const Index> nodes, FactorBackend which)
    : backend(which), pattern(std::move(graph)) {
  const auto n = static_cast<std::size_t>(pattern->nodes());
  assert(fixed.empty() || fixed.size() == n);
  std::vector<std::int32_t> number(n, -1), vertex;
  for (std::size_t i = 0; i < n; ++i)
    if (fixed.empty() || !fixed[i]) {
      number[i] = static_cast<std::int32_t>(vertex.size());
      vertex.push_back(static_cast<std::int32_t>(i));
    }
  std::vector<std::int32_t> start, neighbour;
  build_graph(*pattern, number, vertex.size(), start, neighbour);
  for (const std::int32_t v : fill_reducing_order(start, neighbour))
    base.push_back(vertex[static_cast<std::size_t>(v)]);
  put_last(nodes);
}

FactorPlan::FactorPlan(const FactorPlan& other, std::span<const Index> nodes)
    : backend(other.backend), pattern(other.pattern), base(other.base) {
  put_last(nodes);
}

/// Moves the candidates to the end of the order and says where every entry of A goes.
void FactorPlan::put_last(std::span<const Index> nodes) {
  const auto n = static_cast<std::size_t>(pattern->nodes());
  constexpr char is_fixed = 0, is_free = 1, is_candidate = 2;
  std::vector<char> kind(n, is_fixed);
  for (const std::int32_t i : base) kind[static_cast<std::size_t>(i)] = is_free;
  for (const Index i : nodes)
    if (kind[static_cast<std::size_t>(i)] == is_free) {
      kind[static_cast<std::size_t>(i)] = is_candidate;
      candidates.push_back(i);
    }
  for (const std::int32_t i : base)
    if (kind[static_cast<std::size_t>(i)] == is_free) order.push_back(i);
  for (const Index i : candidates) order.push_back(static_cast<std::int32_t>(i));

  std::vector<std::int32_t> position(n, -1);
  for (std::size_t k = 0; k < order.size(); ++k)
    position[static_cast<std::size_t>(order[k])] = static_cast<std::int32_t>(k);

  const auto each_block = [&](auto&& visit) {
    for (Index i = 0; i < pattern->nodes(); ++i) {
      const std::int32_t p = position[static_cast<std::size_t>(i)];
      if (p < 0) continue;
      for (std::int32_t k = pattern->row_start()[static_cast<std::size_t>(i)];
           k < pattern->row_start()[static_cast<std::size_t>(i) + 1]; ++k) {
        const std::int32_t q =
            position[static_cast<std::size_t>(pattern->column()[static_cast<std::size_t>(k)])];
        if (q >= 0)
          visit(static_cast<std::size_t>(std::min(p, q)), Placed{std::max(p, q), k, p < q});
      }
    }
  };
  // The Schur complement over the candidates is dense in any case (the rest couples every pair).
  // Saying so in the structure makes them one chain of the elimination tree, which keeps it last
  // and whole when the backend reorders the tree.
  const auto first_candidate = order.size() - candidates.size();
  std::vector<std::size_t> start(order.size() + 1, 0);
  each_block([&](std::size_t q, const Placed&) { ++start[q + 1]; });
  for (std::size_t q = first_candidate; q < order.size(); ++q) start[q + 1] = order.size() - q;
  for (std::size_t q = 0; q < order.size(); ++q) start[q + 1] += start[q];
  std::vector<Placed> blocks(start.back());
  std::vector<std::size_t> end(start.begin(), start.end() - 1);
  for (std::size_t q = first_candidate; q < order.size(); ++q)
    for (std::size_t p = q; p < order.size(); ++p)
      blocks[start[q] + p - q] = {static_cast<std::int32_t>(p), -1, false};
  each_block([&](std::size_t q, const Placed& b) {
    if (q < first_candidate)
      blocks[end[q]++] = b;
    else
      blocks[start[q] + static_cast<std::size_t>(b.row) - q] = b;
  });
  for (std::size_t q = 0; q < first_candidate; ++q)
    std::sort(blocks.begin() + static_cast<std::ptrdiff_t>(start[q]),
              blocks.begin() + static_cast<std::ptrdiff_t>(start[q + 1]));

  column_start.push_back(0);
  for (std::size_t q = 0; q < order.size(); ++q) {
    for (std::int32_t c = 0; c < 3; ++c) {
      for (const Placed& b : std::span(blocks).subspan(start[q], start[q + 1] - start[q]))
        for (std::int32_t r = 0; r < 3; ++r) {
          const bool on_diagonal = static_cast<std::size_t>(b.row) == q;
          if (on_diagonal && r < c) continue;
          row.push_back(3 * b.row + r);
          source.push_back(b.slot < 0 ? -1 : 9 * b.slot + (b.transposed ? 3 * c + r : 3 * r + c));
        }
      column_start.push_back(static_cast<std::int32_t>(row.size()));
    }
  }
}

bool FactorPlan::gather(const NodeMatrix& A, Real* entries) const {
  Real poison = 0;  // becomes NaN as soon as one entry is not finite
  for (std::size_t k = 0; k < source.size(); ++k) {
    entries[k] = source[k] < 0 ? 0 : A.values()[source[k]];
    poison += entries[k] * 0;
  }
  return poison == 0;
}

void FactorPlan::restrict_to_free(const Eigen::Ref<const MatX>& full,
                                  Eigen::Ref<MatX> reduced) const {
  for (Index c = 0; c < full.cols(); ++c)
    for (std::size_t k = 0; k < order.size(); ++k)
      reduced.col(c).segment<3>(3 * static_cast<Index>(k)) = full.col(c).segment<3>(3 * order[k]);
}

void FactorPlan::extend(const Eigen::Ref<const MatX>& reduced, Eigen::Ref<MatX> full) const {
  full.setZero();
  for (Index c = 0; c < full.cols(); ++c)
    for (std::size_t k = 0; k < order.size(); ++k)
      full.col(c).segment<3>(3 * order[k]) = reduced.col(c).segment<3>(3 * static_cast<Index>(k));
}

bool has_backend(FactorBackend backend) {
#ifdef SUTURA_WITH_CHOLMOD
  return backend == FactorBackend::cholmod || backend == FactorBackend::eigen;
#else
  return backend == FactorBackend::eigen;
#endif
}

FactorBackend default_backend() {
  return has_backend(FactorBackend::cholmod) ? FactorBackend::cholmod : FactorBackend::eigen;
}

namespace {
struct PlanKey {
  std::shared_ptr<const NodePattern> pattern;
  std::vector<char> fixed;
  std::vector<Index> candidates;
  FactorBackend backend;
  bool operator==(const PlanKey&) const = default;
};
}  // namespace

std::shared_ptr<const FactorPlan> make_factor_plan(std::shared_ptr<const NodePattern> pattern,
                                                   std::span<const char> fixed,
                                                   std::span<const Index> nodes,
                                                   FactorBackend backend, Cache* cache) {
  PlanKey key{pattern, {fixed.begin(), fixed.end()}, {nodes.begin(), nodes.end()}, backend};
  return cached(cache, std::move(key),
                [&] { return std::make_shared<const FactorPlan>(pattern, fixed, nodes, backend); });
}

std::shared_ptr<const FactorPlan> with_candidates(const FactorPlan& plan,
                                                  std::span<const Index> nodes) {
  return std::make_shared<FactorPlan>(plan, nodes);
}

std::span<const Index> candidates_of(const FactorPlan& plan) {
  return plan.candidates;
}

std::unique_ptr<Factor> make_factor(std::shared_ptr<const FactorPlan> plan) {
#ifdef SUTURA_WITH_CHOLMOD
  if (plan->backend == FactorBackend::cholmod) return make_cholmod_factor(std::move(plan));
#endif
  return make_eigen_factor(std::move(plan));
}

}  // namespace sutura::tissue
