#include "sutura/geometry/box_tree.h"

#include <algorithm>
#include <numeric>

namespace sutura {

bool Box::meets_segment(const Vec3& a, const Vec3& b, Real margin) const {
  // Separating axes: the three of the box and its cross products with the segment.
  const Vec3 centre = 0.5 * (low + high), half = 0.5 * (high - low) + Vec3::Constant(margin);
  const Vec3 middle = 0.5 * (a + b) - centre, d = 0.5 * (b - a), reach = d.cwiseAbs();
  for (int i = 0; i < 3; ++i)
    if (std::abs(middle[i]) > half[i] + reach[i]) return false;
  const Vec3 moment = middle.cross(d);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    // Slack for the rounding of the products themselves.
    const Real bound = half[j] * reach[k] + half[k] * reach[j];
    if (std::abs(moment[i]) > bound * (1 + 1e-12) + margin * reach[i]) return false;
  }
  return true;
}

BoxTree::BoxTree(const std::vector<Vec3>& centres) : items_(centres.size()) {
  std::iota(items_.begin(), items_.end(), 0);
  if (!centres.empty()) split(centres, 0, static_cast<Index>(centres.size()));
}

void BoxTree::split(const std::vector<Vec3>& centres, Index first, Index count) {
  constexpr Index leaf = 4;
  const std::size_t n = nodes_.size();
  nodes_.push_back({-1, first, count});
  if (count <= leaf) return;
  Box box;
  for (Index k = first; k < first + count; ++k) box.add(centres[items_[k]]);
  int axis = 0;
  (box.high - box.low).maxCoeff(&axis);
  const Index middle =
      first + count / 2;  // halves: the depth stays below log2 of the number of items
  std::nth_element(items_.begin() + first, items_.begin() + middle, items_.begin() + first + count,
                   [&](Index a, Index b) {
                     const Real x = centres[a][axis], y = centres[b][axis];
                     return x != y ? x < y : a < b;
                   });
  nodes_[n].count = 0;
  split(centres, first, middle - first);
  nodes_[n].right = static_cast<Index>(nodes_.size());
  split(centres, middle, first + count - middle);
}

}  // namespace sutura
