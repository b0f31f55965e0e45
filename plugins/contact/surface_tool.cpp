#include "surface_tool.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pose_maths.h"

namespace sutura::contact {
namespace {

// In units of the mean edge of the triangles.
constexpr Real margin = 0.25;  // a touch is built from this far, before there is one
constexpr Real dip = 0.01;     // what a triangle may be nearer than at its nodes

}  // namespace

void SurfaceTool::learn_nodes() {
  Real sum = 0;
  for (Index t = 0; t < surface_.triangles(); ++t) {
    const Corners c = surface_.now(t);
    for (std::size_t k = 0; k < 3; ++k) {
      sum += (c[(k + 1) % 3] - c[k]).norm();
      const auto node = static_cast<std::size_t>(surface_.nodes(t)[k]);
      if (node >= nodes_.size()) nodes_.resize(node + 1);
      if (nodes_[node].triangle < 0) nodes_[node] = {t, Vec3::Unit(static_cast<Index>(k))};
    }
  }
  edge_ = sum / static_cast<Real>(std::max<Index>(3 * surface_.triangles(), 1));
}

Vec3 SurfaceTool::local(const Vec3& world) const {
  return seen_from(tool_.placed(Configuration::current), world);
}

// Alternating projections: onto the tool, back onto the triangle. Both are convex, so that they
// close in on the two nearest points.
Vec3 SurfaceTool::nearest_weights(const Corners& seen) const {
  Vec3 weights = Vec3::Constant(Real(1) / 3);
  for (int i = 0; i < 30; ++i) {
    const Vec3 p = weights[0] * seen[0] + weights[1] * seen[1] + weights[2] * seen[2];
    const ShapeDistance d = tool_.shape().at(p);
    const Vec3 next = closest_point(Vec3(p - d.distance * d.normal), seen).weights;
    const bool stands = (next - weights).norm() < 1e-9;
    weights = next;
    if (stands) break;
  }
  return weights;
}

void SurfaceTool::find(const TouchedPlaces&, std::vector<Touch>& out) {
  surface_.look();
  if (nodes_.empty()) learn_nodes();
  const Shape& shape = tool_.shape();
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    if (nodes_[node].triangle < 0) continue;
    const Vec3 p = surface_.point(static_cast<Index>(node));
    if (shape.at(local(p)).distance < margin * edge_)
      touch(static_cast<Real>(node), nodes_[node], out);
  }
  if (shape.kind == Shape::Kind::plane) return;  // nowhere nearer than at a node
  const Real first = static_cast<Real>(nodes_.size());
  for (Index t = 0; t < surface_.triangles(); ++t) {
    Corners seen = surface_.now(t);
    for (Vec3& p : seen) p = local(p);
    Real at_nodes = std::numeric_limits<Real>::infinity(), size = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      at_nodes = std::min(at_nodes, shape.at(seen[k]).distance);
      size = std::max(size, (seen[(k + 1) % 3] - seen[k]).norm());
    }
    if (at_nodes > size || at_nodes < 0) continue;
    const Vec3 weights = nearest_weights(seen);
    const Vec3 p = weights[0] * seen[0] + weights[1] * seen[1] + weights[2] * seen[2];
    const Real distance = shape.at(p).distance;
    if (distance < margin * edge_ && distance < at_nodes - dip * edge_)
      touch(first + static_cast<Real>(t), {t, weights}, out);
  }
}

void SurfaceTool::touch(Real name, const Place& place, std::vector<Touch>& out) const {
  const Pose frame = tool_.placed(Configuration::current);
  const Corners c = surface_.now(place.triangle);
  const Vec3 p = place.weights[0] * c[0] + place.weights[1] * c[1] + place.weights[2] * c[2];
  const ShapeDistance d = tool_.shape().at(seen_from(frame, p));
  Touch& t = out.emplace_back();
  t.first_place = name;
  t.triangle = place.triangle;
  t.weights = place.weights;
  t.normal = frame.rotation * d.normal;
  t.along = t.normal.unitOrthogonal();
  t.at = p;
  t.second_local = seen_from(frame, p);
  t.gap = d.distance;
}

Vec3 SurfaceTool::slip(const Touch& t) const {
  const Vec3 tool = at(tool_.placed(Configuration::current), t.second_local) -
                    at(tool_.placed(Configuration::start), t.second_local);
  return surface_.moved(t.triangle, t.weights) - tool;
}

void SurfaceTool::couple(const Touch& t, BlockId block, const Directions& axes,
                         ConstraintBuilder& builder) const {
  PointJacobian J;
  surface_.jacobian(t.triangle, t.weights, J);
  builder.couple(block, surface_.solid(), axes, J, t.at);
}

void SurfaceTool::tell_force(const Touch& t, const Vec3& force) {
  tool_.add_force(-force, t.at);
}

Pair::Tolerance SurfaceTool::tolerance(const Touch&) const {
  return {0.5, std::numeric_limits<Real>::infinity()};
}

Real SurfaceTool::distance() const {
  MovingSurface now(surface_.solid());
  now.look(true);
  Real smallest = std::numeric_limits<Real>::infinity();
  for (Index t = 0; t < now.triangles(); ++t)
    for (const Vec3& p : now.now(t))
      smallest = std::min(smallest, tool_.shape().at(local(p)).distance);
  return smallest;
}

}  // namespace sutura::contact
