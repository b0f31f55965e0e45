#include "rigid_tool.h"

#include "sutura/archive.h"
#include "sutura/geometry/poses.h"

namespace sutura::contact {

void RigidTool::describe(Describe<RigidTool>& d) {
  d.summary(
      "A rigid shape that bodies touch: an instrument, a table. It stands where the scene puts it, "
      "or moves with a track.");
  d.theory(
      "The tool is not a body: it goes where its track says, whatever pushes it, and what pushes "
      "it is read off. Which bodies touch it, and with how much friction, is said by a Contact for "
      "each of them.");
  d.link("motion", &RigidTool::motion_, "What moves it; left out, it stands still.").named_only();
  d.attribute("shape", &RigidTool::kind_, {"plane", "sphere", "capsule", "cylinder", "box"},
              "A plane bounds a half space; a capsule is a cylinder with round ends.");
  d.attribute("centre", &RigidTool::centre_, "m", between(-1e6, 1e6),
              "Centre of the shape; of a plane, a point on it.");
  d.attribute("axis", &RigidTool::axis_, "1", any(),
              "Direction of the axis of a capsule or cylinder, of the third edge of a box; of a "
              "plane, its normal, towards the free side.");
  d.attribute("rotation", &RigidTool::rotation_, "rad", between(-1e4, 1e4),
              "Rotation vector about the centre, after the axis has been laid as said.");
  d.attribute("radius", &RigidTool::radius_, "m", between(1e-6, 1e3),
              "Of a sphere, capsule or cylinder.");
  d.attribute("length", &RigidTool::length_, "m", between(0, 1e3),
              "Of a cylinder, and of the straight part of a capsule.");
  d.attribute("size", &RigidTool::size_, "m", between(1e-6, 1e3), "Three edges of a box.");
  d.output("force", "N", "Of all contacts on the tool, over the last step.",
           [](const RigidTool& t) { return t.applied_.force; });
  d.output("moment", "N m", "Of all contacts on the tool, about its centre.",
           [](const RigidTool& t) { return t.applied_.moment; });
  d.output("position", "m", "Of its centre.",
           [](const RigidTool& t) -> Vec3 { return t.placed(Configuration::current).position; });
}

void RigidTool::initialise(Setup& setup) {
  if (!(axis_.norm() > 0)) {
    setup.error(*this, "'axis' is zero; expected a direction");
    return;
  }
  if (kind_ == Shape::Kind::cylinder && !(length_ > 0)) {
    setup.error(*this, "'length' of a cylinder is zero; expected more, or a flat box");
    return;
  }
  shape_ = {.kind = kind_, .radius = radius_, .half_length = length_ / 2, .half_size = size_ / 2};
  if (kind_ == Shape::Kind::sphere) shape_.half_length = 0;
  const Quat laid = shortest_rotation(Vec3::UnitZ(), axis_);
  const Real angle = rotation_.norm();
  const Quat turned =
      angle > 0 ? Quat(Eigen::AngleAxis<Real>(angle, rotation_ / angle)) : Quat(Quat::Identity());
  as_modelled_ = {centre_, (turned * laid).normalized()};
}

void RigidTool::archive(Archive& a) {
  a("applied", applied_);
}

/// What acted on it in the step before is over.
void RigidTool::drive(const StepContext&) {
  applied_ = {};
}

Pose RigidTool::placed(Configuration c) const {
  if (!motion_ || c == Configuration::rest) return as_modelled_;
  return compose(c == Configuration::start ? motion_->start_pose() : motion_->pose(), as_modelled_);
}

Vec3 RigidTool::moved(const Vec3& local) const {
  return at(placed(Configuration::current), local) - at(placed(Configuration::start), local);
}

void RigidTool::add_force(const Vec3& force, const Vec3& at) {
  applied_.force += force;
  applied_.moment += (at - placed(Configuration::current).position).cross(force);
}

BodyGeometry RigidTool::geometry() const {
  BodyGeometry g;
  const Pose now = placed(Configuration::current);
  for (const Vec3& p : shape_.wireframe()) {
    g.connectivity.push_back(static_cast<Index>(g.points.size()));
    g.points.push_back(at(now, p));
  }
  return g;
}

}  // namespace sutura::contact
