// Touches of two curves, or of a curve with itself.
#pragma once

#include "closest_pair.h"
#include "curve_tree.h"
#include "touch.h"

namespace sutura::contact {

class CurveCurve : public Pair {
 public:
  CurveCurve(const SegmentedCurve& first, const SegmentedCurve& second)
      : first_(first), second_(second), is_self_(&first == &second) {}
  bool find_again(Real first, Real second, Touch& touch) const override;
  Real built_from(const Touch& touch) const override;
  Vec3 slip(const Touch& touch) const override;
  void couple(const Touch& touch, BlockId block, const Directions& axes,
              ConstraintBuilder& builder) const override;
  void couple_shift(const Touch& touch, bool of_first, BlockId block, const Vec3& direction,
                    ConstraintBuilder& builder) const override;
  Real distance() const override;
  Tolerance tolerance(const Touch& touch) const override;
  bool are_one(Real first, Real second) const override;

 protected:
  void look_for_touches(const TouchedPlaces& before, std::vector<Touch>& out) override;

 private:
  const MovingCurve& b() const { return is_self_ ? a_ : b_; }
  const CurveTree& tree_b() const { return is_self_ ? tree_a_ : tree_b_; }
  void look();
  void look_at_start();
  void add_up_turns();
  /// May segments i and j of one curve touch? Only if it turns about between them.
  bool are_apart(std::size_t i, std::size_t j) const;
  /// Calls `meet` with all pairs of segments that may come closer than `margin`.
  template <class Meet>
  void each_pair(std::size_t i, std::size_t j, Real margin, const Meet& meet) const;
  void meet(std::size_t i, std::size_t j, const TouchedPlaces& before, std::vector<Touch>& out);
  Real left_of_overlap(std::size_t i, std::size_t j, Real reach) const;
  Touch touch_at(std::size_t i, std::size_t j, const ClosestPair& at) const;
  /// Is the point of a pair that is closest on its segment also so on the curve around?
  static bool is_lowest(Real u, Real slope, const MovingCurve& curve, std::size_t segment);
  Real needle_arc() const;
  static void drop_doubles(std::vector<Touch>& touches, std::size_t from);

  const SegmentedCurve &first_, &second_;
  bool is_self_;
  MovingCurve a_, b_;
  CurveTree tree_a_, tree_b_;
  std::vector<Real> start_turn_;  ///< of each segment of a (rad)
  std::vector<Real> turned_;      ///< up to each segment of a, over the step the most (rad)
};

}  // namespace sutura::contact
