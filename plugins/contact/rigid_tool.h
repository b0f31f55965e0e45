// Component Tool: a rigid shape, fixed or on a track, that bodies touch.
#pragma once

#include "shape.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"
#include "sutura/tool.h"

namespace sutura::contact {

class RigidTool : public Component, public Driver, public Drawing {
 public:
  static constexpr const char* interface_name = "Tool";
  static void describe(Describe<RigidTool>& d);
  void initialise(Setup& setup) override;
  void archive(Archive& archive) override;
  void drive(const StepContext& context) override;
  BodyGeometry geometry() const override;

  const Shape& shape() const { return shape_; }
  /// The frame of the shape, at the start of the step or now: at its end.
  Pose placed(Configuration c) const;
  /// Displacement over the step of a point of the shape, seen from it (m).
  Vec3 moved(const Vec3& local) const;
  /// Of a contact, on the tool, over the step.
  void add_force(const Vec3& force, const Vec3& at);

 private:
  Link<Tool> motion_;
  Shape::Kind kind_ = Shape::Kind::plane;
  Vec3 centre_ = Vec3::Zero(), axis_ = Vec3::UnitZ(), rotation_ = Vec3::Zero();
  Vec3 size_{0.01, 0.01, 0.01};
  Real radius_ = 1e-3, length_ = 1e-2;

  Shape shape_;
  Pose as_modelled_;  ///< frame of the shape
  Wrench applied_;    ///< by contacts, about the centre
};

}  // namespace sutura::contact
