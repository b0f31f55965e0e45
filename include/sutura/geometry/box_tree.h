// A tree of axis-aligned boxes over triangles, tetrahedra or segments. It is built once, from where
// the items are at that time; its boxes are refitted to wherever they are later. So one tree serves
// several configurations, each with boxes of its own.
#pragma once

#include <limits>
#include <vector>

#include "sutura/types.h"

namespace sutura {

/// Empty as made: it holds nothing, and meets nothing.
struct Box {
  Vec3 low = Vec3::Constant(std::numeric_limits<Real>::infinity());    ///< m
  Vec3 high = Vec3::Constant(-std::numeric_limits<Real>::infinity());  ///< m
  void add(const Vec3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void add(const Box& b) {
    low = low.cwiseMin(b.low);
    high = high.cwiseMax(b.high);
  }
  /// This box, larger by `margin` (m) on every side.
  Box grown(Real margin) const {
    Box out;
    out.low = low.array() - margin;
    out.high = high.array() + margin;
    return out;
  }
  /// Boxes that only touch meet, too.
  bool meets(const Box& b) const {
    return (low.array() <= b.high.array()).all() && (b.low.array() <= high.array()).all();
  }
  /// From the nearest point of the box; 0 inside (m^2).
  Real squared_distance(const Vec3& p) const {
    return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
  }
  /// False only if the segment surely misses the box grown by `margin`.
  bool meets_segment(const Vec3& a, const Vec3& b, Real margin) const;
};

class BoxTree {
 public:
  /// One per node of the tree; the first one bounds everything.
  using Boxes = std::vector<Box>;

  /// `centres`: one per item.
  explicit BoxTree(const std::vector<Vec3>& centres);

  /// boxes <- bounds of every node of the tree; `bounds(i)` returns the Box of item i. Allocates
  /// the first time only.
  template <class Bounds>
  void refit(Boxes& boxes, Bounds bounds) const {
    boxes.resize(nodes_.size());
    for (std::size_t n = nodes_.size(); n-- > 0;) {  // children come after their parent
      const Node& node = nodes_[n];
      Box box;
      if (node.count > 0)
        for (Index k = node.first; k < node.first + node.count; ++k)
          box.add(bounds(items_[static_cast<std::size_t>(k)]));
      else {
        box.add(boxes[n + 1]);
        box.add(boxes[static_cast<std::size_t>(node.right)]);
      }
      boxes[n] = box;
    }
  }
  /// Calls `item(i)` for the items of every leaf that can be reached through boxes that
  /// `enter(box)`. The answer of a query must not depend on the order of the calls.
  template <class Enter, class Item>
  void visit(const Boxes& boxes, Enter enter, Item item) const {
    if (nodes_.empty()) return;
    Index stack[64];  // the depth of the tree stays below log2 of the number of items
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const Index n = stack[--depth];
      if (!enter(boxes[static_cast<std::size_t>(n)])) continue;
      const Node& node = nodes_[static_cast<std::size_t>(n)];
      if (node.count > 0)
        for (Index k = node.first; k < node.first + node.count; ++k)
          item(items_[static_cast<std::size_t>(k)]);
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
