#include "rigid_tool.h"

#include "read_triangles.h"
#include "sutura/archive.h"
#include "sutura/geometry/poses.h"
#include "sutura/units.h"

namespace sutura::contact {

namespace {
/// In the order of RigidTool::Kind.
const std::vector<std::string> kind_names{"plane", "sphere", "capsule", "cylinder", "box", "mesh"};
}  // namespace

void RigidTool::describe(Describe<RigidTool>& d) {
  d.summary(
      "A rigid shape that bodies touch: an instrument, a table. It stands where the scene puts it, "
      "or moves with a track.");
  d.theory(
      "The tool is not a body: it goes where its track says, whatever pushes it, and what pushes "
      "it is read off. Which bodies touch it, and with how much friction, is said by a Contact for "
      "each of them.");
  d.link("motion", &RigidTool::motion_, "What moves it; left out, it stands still.").named_only();
  d.attribute(
      "shape", &RigidTool::kind_, kind_names,
      "A plane bounds a half space; a capsule is a cylinder with round ends; a mesh is read "
      "from a file.");
  d.attribute("file", &RigidTool::file_,
              "Of a mesh: a closed surface of triangles, as OBJ, STL or PLY.");
  d.attribute("unit", &RigidTool::unit_, {"m", "cm", "mm"}, "The unit of length of that file.");
  d.attribute("centre", &RigidTool::centre_, "m", between(-1e6, 1e6),
              "Centre of the shape; of a plane, a point on it; of a mesh, where its origin is.");
  d.attribute(
      "axis", &RigidTool::axis_, "1", any(),
      "Direction of the axis of a capsule or cylinder, of the third edge of a box; of a "
      "plane, its normal, towards the free side; of a mesh, of its z axis. The x and y of a "
      "box or mesh are where the shortest turn from z to 'axis' takes them: for 0 0 1 "
      "along x and y, for 1 0 0 along -z and y, for 0 1 0 along x and -z.");
  d.attribute("rotation", &RigidTool::rotation_, "rad", between(-1e4, 1e4),
              "Rotation vector about the centre, after the axis has been laid as said.");
  d.attribute("radius", &RigidTool::radius_, "m", between(1e-6, 1e3),
              "Of a sphere, capsule or cylinder.");
  d.attribute("length", &RigidTool::length_, "m", between(0, 1e3),
              "Of a cylinder, and of the straight part of a capsule.");
  d.attribute("size", &RigidTool::size_, "m", between(1e-6, 1e3),
              "Three edges of a box: along its x, its y and 'axis'.");
  d.attribute("rounding", &RigidTool::rounding_, "m", between(0, 1e3),
              "Radius to which the edges and corners of a box are rounded.");
  d.output("force", "N", "Of all contacts on the tool, at the end of the last step.",
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
  if (kind_ == Kind::cylinder && !(length_ > 0)) {
    setup.error(*this, "'length' of a cylinder is zero; expected more, or a flat box");
    return;
  }
  if (kind_ == Kind::box && rounding_ > size_.minCoeff() / 2) {
    setup.error(*this, "'rounding' is " + format_real(rounding_) +
                           " m; expected at most half of the smallest edge, " +
                           format_real(size_.minCoeff() / 2) + " m");
    return;
  }
  const std::string kind = kind_names[static_cast<std::size_t>(kind_)];
  const auto unless = [&](bool used, std::initializer_list<const char*> attributes) {
    if (!used) setup.warn_without_effect(*this, attributes, "the shape is a " + kind);
  };
  const bool is_round = kind_ == Kind::sphere || kind_ == Kind::capsule || kind_ == Kind::cylinder;
  unless(kind_ == Kind::mesh, {"unit"});
  unless(kind_ == Kind::box, {"size", "rounding"});
  unless(is_round, {"radius"});
  unless(kind_ == Kind::capsule || kind_ == Kind::cylinder, {"length"});
  if (kind_ == Kind::mesh) {
    read_mesh(setup);
  } else if (!file_.path.empty()) {
    setup.error(*this, "'file' is for a mesh; expected shape=\"mesh\"");
    return;
  }
  shape_ = {.kind = kind_ == Kind::mesh ? Shape::Kind::box : static_cast<Shape::Kind>(kind_),
            .radius = radius_,
            .half_length = length_ / 2,
            .half_size = size_ / 2,
            .rounding = rounding_};
  if (kind_ == Kind::sphere) shape_.half_length = 0;
  const Quat laid = shortest_rotation(Vec3::UnitZ(), axis_);
  const Real angle = rotation_.norm();
  const Quat turned =
      angle > 0 ? Quat(Eigen::AngleAxis<Real>(angle, rotation_ / angle)) : Quat(Quat::Identity());
  as_modelled_ = {centre_, (turned * laid).normalized()};
}

void RigidTool::read_mesh(Setup& setup) {
  const std::filesystem::path file = setup.resolve(file_.path);
  TriangleReading reading = read_triangles(file);
  if (reading.problem) {
    const FileProblem& p = *reading.problem;
    // A problem of a line is shown there; one of the whole file, where the scene names it.
    if (p.line > 0)
      setup.diagnostics.error({file.string(), p.line}, path(), p.message, Category::file);
    else
      setup.error(*this,
                  "mesh file '" + file.string() + "': " + p.message +
                      (std::filesystem::exists(file) ? "" : setup.did_you_mean_file(file_.path)),
                  Category::file);
    return;
  }
  const Real metres = unit_ == Unit::mm ? 1e-3 : unit_ == Unit::cm ? 1e-2 : 1;
  Box box;
  for (Vec3& p : reading.data.points) box.add(p *= metres);
  std::string error;
  mesh_ = TriangleMesh::close(reading.data, error);
  if (!mesh_) {
    setup.error(*this, "mesh file '" + file.string() + "': " + error, Category::file);
    return;
  }
  constexpr Real large = 1;  // m
  if (const Real size = (box.high - box.low).norm(); size > large)
    setup.warning(*this, "the mesh is " + format_real(size) + " m large; is it in mm?");
  setup.note_if_outside(*this, file_.path);
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

Pose RigidTool::placed_without_spin(Configuration c) const {
  return c == Configuration::current ? placed(c) : without_spin(placed(c));
}

Pose RigidTool::placed_half_way() const {
  return motion_ ? without_spin(compose(motion_->half_way(), as_modelled_)) : as_modelled_;
}

Pose RigidTool::without_spin(Pose out) const {
  if (mesh_ || shape_.kind == Shape::Kind::box) return out;
  const Quat now = placed(Configuration::current).rotation;
  if (shape_.kind == Shape::Kind::sphere) {
    out.rotation = now;
  } else {
    const Vec3 axis = now * Vec3::UnitZ(), axis_then = out.rotation * Vec3::UnitZ();
    out.rotation = (shortest_rotation(axis, axis_then) * now).normalized();
  }
  return out;
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
  if (mesh_) {
    for (const Vec3& p : mesh_->points()) g.points.push_back(at(now, p));
    for (const auto& t : mesh_->triangles())
      for (std::size_t k = 0; k < 3; ++k)
        if (const Index a = t[k], b = t[(k + 1) % 3]; a < b) {
          g.connectivity.push_back(a);
          g.connectivity.push_back(b);
        }
    return g;
  }
  for (const Vec3& p : shape_.wireframe()) {
    g.connectivity.push_back(static_cast<Index>(g.points.size()));
    g.points.push_back(at(now, p));
  }
  return g;
}

}  // namespace sutura::contact
