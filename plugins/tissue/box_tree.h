// A bounding-volume tree over triangles or tets: built once on the rest shape, boxes refitted to
// any other configuration.
#pragma once

#include <functional>
#include <vector>

#include "sutura/types.h"

namespace sutura {

struct Box {
  Vec3 low = Vec3::Constant(std::numeric_limits<Real>::infinity());
  Vec3 high = Vec3::Constant(-std::numeric_limits<Real>::infinity());
  void add(const Vec3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void add(const Box& b) {
    low = low.cwiseMin(b.low);
    high = high.cwiseMax(b.high);
  }
  Real squared_distance(const Vec3& p) const {
    return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
  }
  /// False only if the segment surely misses the box grown by `margin`.
  bool meets_segment(const Vec3& a, const Vec3& b, Real margin) const;
};

class BoxTree {
 public:
  using Boxes = std::vector<Box>;  ///< one per tree node

  /// `centres`: one per item.
  explicit BoxTree(const std::vector<Vec3>& centres);

  /// boxes <- bounds of every tree node; `bounds(i)`: of item i.
  template <class ItemBox>
  void refit(Boxes& boxes, ItemBox bounds) const {
    boxes.assign(nodes_.size(), Box{});
    for (std::size_t n = nodes_.size(); n-- > 0;) {  // children come after their parent
      const Node& node = nodes_[n];
      if (node.count > 0)
        for (Index k = node.first; k < node.first + node.count; ++k)
          boxes[n].add(bounds(items_[k]));
      else {
        boxes[n].add(boxes[n + 1]);
        boxes[n].add(boxes[node.right]);
      }
    }
  }
  /// Calls `item(i)` for the items of every leaf that can be reached through boxes that `enter`.
  /// The answer of a query must not depend on the order of the calls.
  template <class Enter, class Item>
  void visit(const Boxes& boxes, Enter enter, Item item) const {
    if (nodes_.empty()) return;
    Index stack[64];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const Index n = stack[--depth];
      if (!enter(boxes[n])) continue;
      const Node& node = nodes_[n];
      if (node.count > 0)
        for (Index k = node.first; k < node.first + node.count; ++k) item(items_[k]);
      else {
        stack[depth++] = node.right;
        stack[depth++] = n + 1;
      }
    }
  }

 private:
  struct Node {
    Index right = -1;  ///< the left child is the next node
    Index first = 0;
    Index count = 0;  ///< 0 for an inner node
  };
  void split(const std::vector<Vec3>& centres, Index first, Index count);

  std::vector<Node> nodes_;
  std::vector<Index> items_;
};

}  // namespace sutura
