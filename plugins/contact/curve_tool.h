// Touches of a curve and a rigid tool.
#pragma once

#include "moving_curve.h"
#include "rigid_tool.h"
#include "touch.h"

namespace sutura::contact {

class CurveTool : public Pair {
 public:
  CurveTool(const SegmentedCurve& curve, RigidTool& tool) : curve_(curve), tool_(tool) {}
  void find(const TouchedPlaces& before, std::vector<Touch>& out) override;
  Vec3 slip(const Touch& touch) const override;
  void couple(const Touch& touch, BlockId block, const Directions& axes,
              ConstraintBuilder& builder) const override;
  void tell_force(const Touch& touch, const Vec3& force) override;
  Real distance() const override;
  Tolerance tolerance(const Touch& touch) const override;

 private:
  /// Of the centreline of segment s, seen from the shape, at u.
  ShapeDistance from_tool(const CurveSegment& s, Real u) const {
    return tool_.shape().at(s.point(u));
  }
  void look();
  Real lowest_between(const CurveSegment& s, Real low, Real high) const;
  void find_at_node(std::size_t node, std::vector<Touch>& out);
  void find_inside(std::size_t segment, const TouchedPlaces& before, std::vector<Touch>& out);
  void touch(std::size_t segment, Real u, std::vector<Touch>& out) const;
  bool is_far(std::size_t segment) const;

  const SegmentedCurve& curve_;
  RigidTool& tool_;
  MovingCurve seen_;  ///< from the shape
};

}  // namespace sutura::contact
