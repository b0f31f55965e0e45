// Touches of a curve and a rigid tool.
#pragma once

#include "bulge.h"
#include "moving_curve.h"
#include "tool_pair.h"

namespace sutura::contact {

class CurveTool : public ToolPair {
 public:
  CurveTool(const SegmentedCurve& curve, RigidTool& tool) : ToolPair(tool), curve_(curve) {}
  bool find_again(Real first, Real second, Touch& touch) const override;
  Real built_from(const Touch& touch) const override;
  Vec3 slip(const Touch& touch) const override;
  Real rolled(const Touch& touch) const override;
  void couple(const Touch& touch, BlockId block, const Directions& axes,
              ConstraintBuilder& builder) const override;
  Real distance() const override;
  Tolerance tolerance(const Touch& touch) const override;

 protected:
  void look_for_touches(const TouchedPlaces& before, std::vector<Touch>& out) override;
  bool keep() override;
  bool may_go_on() const override;

 private:
  /// Of the centreline of segment s, seen from the shape, at u.
  ShapeDistance from_tool(const CurveSegment& s, Real u) const {
    return tool_.shape().at(s.point(u));
  }
  void look();
  void look_at_beginning();
  /// The segment on which a node is, and where.
  std::pair<std::size_t, Real> place_of(std::size_t node) const;
  Real lowest_between(const CurveSegment& s, Real low, Real high, int halvings) const;
  Real dip_at(const CurveSegment& s, Real u, Real distance) const;
  /// Where on the segment it is nearest to the tool. No point of it is nearer than `distance`,
  /// which is exact where it is less than `exact` (m).
  struct Lowest {
    Real u = 0, distance = 0;
  };
  Lowest lowest(const CurveSegment& s, Real exact) const;
  void find_at_node(std::size_t node, std::vector<Touch>& out);
  void find_inside(std::size_t segment, const TouchedPlaces& before, std::vector<Touch>& out);
  /// The way is free up to a time, from which on `p` of the segment there would be too near.
  void bar(std::size_t segment, Real u, Real way, std::vector<Touch>& out);
  Touch touch_at(std::size_t segment, Real u, const Facet& on) const;
  /// All along its way, which may lead so far beside the straight one (m)?
  bool is_far(std::size_t segment, Real aside) const;
  /// Part of its way on which no point of the segment is nearer than its clearance and `more` (m);
  /// and where on the segment one then is.
  Real way_of(std::size_t segment, Real more, Lowest& at) const;

  const SegmentedCurve& curve_;
  MovingCurve seen_;  ///< from the shape
  ToolWay way_;
  // Where ways begin, from the shape:
  std::vector<ShapeDistance> begin_at_node_;
  std::vector<Real> begin_room_;     ///< no point of a segment is nearer (m)
  std::vector<std::size_t> barred_;  ///< segments, on the way that was looked at last
};

}  // namespace sutura::contact
