#include "curve_tree.h"

#include <bit>
#include <limits>

namespace sutura::contact {

CurveTree::Box CurveTree::of(const CurveSegment& start, const CurveSegment& now) {
  Vec3 from[4], to[4];
  MovingCurve::hull(start, from), MovingCurve::hull(now, to);
  Box box{from[0].array(), from[0].array(), (to[0] - from[0]).array(), (to[0] - from[0]).array()};
  for (int k = 1; k < 4; ++k) {
    box.low = box.low.min(from[k].array()), box.high = box.high.max(from[k].array());
    const Eigen::Array3d motion = (to[k] - from[k]).array();
    box.least = box.least.min(motion), box.most = box.most.max(motion);
  }
  box.low -= start.radius;
  box.high += start.radius;
  return box;
}

void CurveTree::fit(const MovingCurve& curve) {
  constexpr Real far = std::numeric_limits<Real>::max() / 8;
  const Eigen::Array3d none = Eigen::Array3d::Constant(far);
  leaves_ = curve.size();
  first_leaf_ = std::bit_ceil(leaves_);
  boxes_.resize(2 * first_leaf_);
  for (std::size_t i = 0; i < first_leaf_; ++i)
    boxes_[first_leaf_ + i] =
        i < leaves_ ? of(curve.from(i), curve.now[i]) : Box{none, -none, none, -none};
  for (std::size_t k = first_leaf_; k-- > 1;) {
    const Box &a = boxes_[2 * k], &b = boxes_[2 * k + 1];
    boxes_[k] = {a.low.min(b.low), a.high.max(b.high), a.least.min(b.least), a.most.max(b.most)};
  }
}

CurveTree::Span CurveTree::span(std::size_t node) const {
  const auto depth = static_cast<std::size_t>(std::bit_width(first_leaf_) - std::bit_width(node));
  const std::size_t begin = (node << depth) - first_leaf_;
  return {std::min(begin, leaves_), std::min(begin + (std::size_t{1} << depth), leaves_)};
}

/// The difference of two boxes, at the start and at the end of the step: does the box around both
/// contain zero?
bool CurveTree::may_meet(const CurveTree& a, std::size_t i, const CurveTree& b, std::size_t j,
                         Real margin) {
  const Box &p = a.boxes_[i], &q = b.boxes_[j];
  const Eigen::Array3d low = p.low - q.high, high = p.high - q.low;
  const Eigen::Array3d end_low = low + p.least - q.most, end_high = high + p.most - q.least;
  return (low.min(end_low) <= margin).all() && (high.max(end_high) >= -margin).all();
}

}  // namespace sutura::contact
