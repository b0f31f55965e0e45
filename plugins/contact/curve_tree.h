// Boxes around a moving curve, as a binary tree over its segments in their order: the order along
// the curve is the hierarchy, so there is nothing to build, only boxes to fit.
#pragma once

#include <vector>

#include "moving_curve.h"

namespace sutura::contact {

class CurveTree {
 public:
  void fit(const MovingCurve& curve);
  /// Nodes are numbered from 1; node k has the children 2k and 2k + 1; leaf i is node first_leaf +
  /// i.
  std::size_t first_leaf() const { return first_leaf_; }
  /// Segments below a node.
  struct Span {
    std::size_t begin, end;
  };
  Span span(std::size_t node) const;
  /// Can what is in the two nodes come closer than `margin` on their ways?
  static bool may_meet(const CurveTree& a, std::size_t i, const CurveTree& b, std::size_t j,
                       Real margin);

 private:
  struct Box {
    Eigen::Array3d low, high;    ///< at the start, with the radius
    Eigen::Array3d least, most;  ///< motion of its points over the step
  };
  static Box of(const CurveSegment& start, const CurveSegment& now);
  std::vector<Box> boxes_;
  std::size_t leaves_ = 0, first_leaf_ = 1;
};

}  // namespace sutura::contact
