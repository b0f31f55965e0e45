// A surface that touches: that of a solid, which moves as its nodes do, or that of a tool, which is
// rigid and takes whatever pushes it.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "rigid_tool.h"
#include "sutura/constraints.h"
#include "sutura/geometry/triangle_surface.h"

namespace sutura::contact {

class Boundary {
 public:
  virtual ~Boundary() = default;
  virtual TriangleSurface surface(Configuration c) const = 0;
  /// How deep p is inside of it, now (m); 0 outside.
  virtual Real depth(const Vec3& p) const = 0;
  /// From p to the nearest point of the surface, now, if that is within `reach`; else infinite (m).
  virtual Real distance(const Vec3& p, Real reach) const = 0;
  /// Adds directions times the motion of a point of a triangle to the rows of a block.
  virtual void couple(ConstraintBuilder& builder, BlockId block, const Directions& directions,
                      Index triangle, const Vec3& weights, const Vec3& at) const = 0;
  /// Goes where it is told, whatever pushes it.
  virtual bool is_rigid() const { return false; }
  /// Whose surface it is, or null.
  virtual const RigidTool* tool() const { return nullptr; }
  /// After the step: a force on it.
  virtual void tell_force(const Vec3& /*force*/, const Vec3& /*at*/) const {}
};

class SolidBoundary : public Boundary {
 public:
  explicit SolidBoundary(const MeshedSolid& solid) : solid_(solid) {}
  TriangleSurface surface(Configuration c) const override { return solid_.surface(c); }
  Real depth(const Vec3& p) const override;
  Real distance(const Vec3& p, Real reach) const override;
  void couple(ConstraintBuilder& builder, BlockId block, const Directions& directions,
              Index triangle, const Vec3& weights, const Vec3& at) const override;

 private:
  const MeshedSolid& solid_;
};

/// Of a tool that is a mesh. On its convex edges it has nodes at distances of `longest` at most
/// (m), or of a 256th of its size where that is more.
class ToolBoundary : public Boundary {
 public:
  explicit ToolBoundary(RigidTool& tool, Real longest = std::numeric_limits<Real>::infinity());
  TriangleSurface surface(Configuration c) const override;
  Real depth(const Vec3& p) const override;
  Real distance(const Vec3& p, Real reach) const override;
  void couple(ConstraintBuilder&, BlockId, const Directions&, Index, const Vec3&,
              const Vec3&) const override {}
  bool is_rigid() const override { return true; }
  const RigidTool* tool() const override { return &tool_; }
  void tell_force(const Vec3& force, const Vec3& at) const override { tool_.add_force(force, at); }

 private:
  Real signed_distance(const Vec3& p) const;

  RigidTool& tool_;
  TriangleData mesh_;  ///< seen from the frame of the shape
  struct Placed {
    Pose frame;
    std::vector<Real> positions;   ///< of the nodes there (m)
    std::uint64_t generation = 0;  ///< 0: nowhere yet
  };
  mutable std::array<Placed, 3> placed_;  ///< by configuration
  mutable std::uint64_t generation_ = 0;
};

}  // namespace sutura::contact
