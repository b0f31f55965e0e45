// Touches of the surface of a solid and a rigid tool: at the nodes of the surface, and inside of a
// triangle where the tool presses between them.
#pragma once

#include "moving_surface.h"
#include "rigid_tool.h"
#include "touch.h"

namespace sutura::contact {

class SurfaceTool : public Pair {
 public:
  SurfaceTool(const MeshedSolid& solid, RigidTool& tool) : surface_(solid), tool_(tool) {}
  void find(const TouchedPlaces& before, std::vector<Touch>& out) override;
  Vec3 slip(const Touch& touch) const override;
  void couple(const Touch& touch, BlockId block, const Directions& axes,
              ConstraintBuilder& builder) const override;
  void tell_force(const Touch& touch, const Vec3& force) override;
  Real distance() const override;
  Tolerance tolerance(const Touch& touch) const override;

 private:
  struct Place {
    Index triangle = -1;
    Vec3 weights = Vec3::Zero();
  };
  /// A triangle of every node of the surface, and the mean length of edges.
  void learn_nodes();
  Vec3 local(const Vec3& world) const;
  /// The point of a triangle that is nearest to the tool, of those outside of it.
  Vec3 nearest_weights(const Corners& seen) const;
  void touch(Real name, const Place& place, std::vector<Touch>& out) const;

  MovingSurface surface_;
  RigidTool& tool_;
  std::vector<Place> nodes_;  ///< by node of the solid; those inside have none
  Real edge_ = 0;             ///< m
};

}  // namespace sutura::contact
