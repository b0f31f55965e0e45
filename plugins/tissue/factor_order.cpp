// Fill-reducing orders of the graph of nodes. Ordering nodes rather than degrees of freedom makes a
// graph three times smaller, for the same fill.
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include "factor_plan.h"

#ifdef SUTURA_WITH_CHOLMOD
#include <metis.h>

#include <cstdlib>
#include <mutex>
#endif

namespace sutura::tissue {
namespace {

#ifdef SUTURA_WITH_CHOLMOD
/// METIS seeds and draws from the random numbers of the C library. While this lives they come from
/// a state of their own, and those of the host go on where they were.
class OwnRandomNumbers {
 public:
  OwnRandomNumbers() : of_host_(initstate(1, state_, sizeof state_)) {}
  ~OwnRandomNumbers() { setstate(of_host_); }
  OwnRandomNumbers(const OwnRandomNumbers&) = delete;
  OwnRandomNumbers& operator=(const OwnRandomNumbers&) = delete;

 private:
  char state_[128];  // as long as the library's own: the same generator
  char* of_host_;
};
#endif

std::vector<std::int32_t> minimum_degree(const std::vector<std::int32_t>& start,
                                         const std::vector<std::int32_t>& neighbour) {
  const auto n = static_cast<Index>(start.size()) - 1;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n; ++i) {
    entries.emplace_back(static_cast<int>(i), static_cast<int>(i), 1.0);
    for (std::int32_t k = start[static_cast<std::size_t>(i)];
         k < start[static_cast<std::size_t>(i) + 1]; ++k)
      entries.emplace_back(neighbour[static_cast<std::size_t>(k)], static_cast<int>(i), 1.0);
  }
  Eigen::SparseMatrix<double> graph(n, n);
  graph.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> p;
  Eigen::AMDOrdering<int>()(graph, p);
  return {p.indices().data(), p.indices().data() + n};
}

}  // namespace

std::vector<std::int32_t> fill_reducing_order(const std::vector<std::int32_t>& start,
                                              const std::vector<std::int32_t>& neighbour) {
  if (start.size() <= 1) return {};
#ifdef SUTURA_WITH_CHOLMOD
  // Below a few hundred nodes minimum degree is as good and quicker to find.
  if (start.size() > 500 && !neighbour.empty()) {
    static_assert(sizeof(idx_t) == sizeof(std::int32_t));
    auto n = static_cast<idx_t>(start.size() - 1);
    std::vector<idx_t> xadj(start), adjacency(neighbour), order(start.size() - 1), position(order);
    // Two calls at once would disturb each other's random numbers, and with them the order and the
    // last bits of every result.
    static std::mutex one_at_a_time;
    const std::lock_guard lock(one_at_a_time);
    const OwnRandomNumbers own;
    if (METIS_NodeND(&n, xadj.data(), adjacency.data(), nullptr, nullptr, order.data(),
                     position.data()) == METIS_OK)
      return order;
  }
#endif
  return minimum_degree(start, neighbour);
}

}  // namespace sutura::tissue
