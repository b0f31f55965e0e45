// Touches of the surface of a solid and a rigid tool: at the nodes of the surface, and inside of a
// triangle where the tool presses between them.
#pragma once

#include <vector>

#include "bulge.h"
#include "moving_curve.h"
#include "moving_surface.h"
#include "tool_pair.h"

namespace sutura::contact {

class SurfaceTool : public ToolPair {
 public:
  SurfaceTool(std::shared_ptr<const Boundary> boundary, RigidTool& tool)
      : ToolPair(tool), surface_(std::move(boundary)) {}
  Real built_from(const Touch& touch) const override;
  Vec3 slip(const Touch& touch) const override;
  void couple(const Touch& touch, BlockId block, const Directions& axes,
              ConstraintBuilder& builder) const override;
  Real unseen_overlap() override;
  bool sees_left_overlap() const override { return true; }
  Real distance() const override;
  Tolerance tolerance(const Touch& touch) const override;

 protected:
  void look_for_touches(const TouchedPlaces& before, std::vector<Touch>& out) override;

 private:
  struct Place {
    Index triangle = -1;
    Vec3 weights = Vec3::Zero();
  };
  Vec3 seen(const Vec3& world, Configuration c) const;
  /// Seen from the tool, on its way.
  Corners seen_at(Index triangle, Real time) const;
  /// The point of a triangle that is nearest to what is left of the tool without a layer (m): where
  /// it is nearest to the tool, or deepest in it. It goes on only where that gains `worth` of the
  /// way (1).
  TrianglePoint nearest(const Corners& seen, Real layer, Real worth) const;
  /// How a triangle and the tool face each other: at which point of the triangle, in which plane.
  struct Facing {
    Vec3 weights, point;
    Facet on;
  };
  Facing facing(const Corners& seen) const;
  /// Of a triangle to the tool, or how deep it is inside, up to `deepest` (m).
  Real distance_of(const Corners& seen, Real deepest) const;
  /// So deep inside nothing may be on its way (m).
  Real allowed() const;
  /// Part of the way of a node or of a triangle on which nothing is deeper in the tool than touches
  /// see.
  template <class At>
  Real way_of(Real motion, const At& distance) const;
  void find_at_node(std::size_t number, std::vector<Touch>& out);
  void find_lying();
  /// Does a side of the tool lie on the surface at a corner of this triangle?
  bool lies_beside(Index triangle) const {
    for (const Index n : surface_.nodes(triangle))
      if (lies_at_[static_cast<std::size_t>(n)]) return true;
    return false;
  }
  void find_inside(Index triangle, const TouchedPlaces& before, std::vector<Touch>& out);
  void leave(const Corners& before, Touch& touch) const;
  void touch(Real name, const Place& place, const Facet& on, std::vector<Touch>& out) const;

  MovingSurface surface_;
  ToolWay way_;
  std::vector<char> lies_at_;  ///< by node: a side of the tool lies on a triangle there
  Real deepest_ = 0;           ///< that a triangle is inside of the tool (m)
};

}  // namespace sutura::contact
