// Component Tool: a rigid shape, fixed or on a track, that bodies touch.
#pragma once

#include <memory>

#include "shape.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"
#include "sutura/tool.h"
#include "triangle_mesh.h"

namespace sutura::contact {

class RigidTool : public Component, public Driver, public Drawing {
 public:
  static constexpr const char* interface_name = "Tool";
  static void describe(Describe<RigidTool>& d);
  void initialise(Setup& setup) override;
  void archive(Archive& archive) override;
  void drive(const StepContext& context) override;
  BodyGeometry geometry() const override;

  /// Not of a mesh.
  const Shape& shape() const { return shape_; }
  /// Or null. Seen from the frame of the shape.
  const TriangleMesh* mesh() const { return mesh_ ? &*mesh_ : nullptr; }
  /// The frame of the shape, at the start of the step or now: at its end.
  Pose placed(Configuration c) const;
  /// As `placed`, but the start without what a shape of revolution has spun about its own axis
  /// since: that moves nothing out of its way. Seen from there and from here, what rests beside a
  /// drum has not gone through it however far the drum has turned.
  Pose placed_without_spin(Configuration c) const;
  /// Half way through the step; likewise without spin.
  Pose placed_half_way() const;
  /// Displacement over the step of a point of the shape, seen from it (m).
  Vec3 moved(const Vec3& local) const;
  /// Of a contact, on the tool, over the step.
  void add_force(const Vec3& force, const Vec3& at);

 private:
  enum class Kind {
    plane,
    sphere,
    capsule,
    cylinder,
    box,
    mesh
  };  ///< those of Shape, and one more
  enum class Unit { m, cm, mm };
  void read_mesh(Setup& setup);
  /// `then`, without what a shape of revolution spins from there to now.
  Pose without_spin(Pose then) const;

  Link<Tool> motion_;
  Kind kind_ = Kind::plane;
  File file_;
  Unit unit_ = Unit::m;
  Vec3 centre_ = Vec3::Zero(), axis_ = Vec3::UnitZ(), rotation_ = Vec3::Zero();
  Vec3 size_{0.01, 0.01, 0.01};
  Real rounding_ = 0;
  Real radius_ = 1e-3, length_ = 1e-2;

  Shape shape_;
  std::optional<TriangleMesh> mesh_;
  Pose as_modelled_;  ///< frame of the shape
  Wrench applied_;    ///< by contacts, about the centre
};

}  // namespace sutura::contact
