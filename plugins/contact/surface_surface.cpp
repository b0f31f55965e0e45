#include "surface_surface.h"

#include <cmath>
#include <limits>

namespace sutura::contact {
namespace {

// In units of the mean edge of the triangles.
constexpr Real depth = 0.5;    // a node that has come through is found so far behind a triangle
constexpr Real margin = 0.25;  // a touch is built from this far, before there is one
constexpr Real beside = 0.1;   // a node may stand so far beside a triangle
// Cosine between the normal of a node and that of a triangle that faces it, at most.
constexpr Real facing = -0.2;

class Nowhere : public TouchedPlaces {
  Real between(Real, Real) const override { return std::numeric_limits<Real>::quiet_NaN(); }
};

}  // namespace

void SurfaceSurface::add_normals(const MovingSurface& surface, std::vector<Vec3>& normals) {
  for (Vec3& n : normals) n.setZero();
  for (Index t = 0; t < surface.triangles(); ++t) {
    const Corners c = surface.now(t);
    const Vec3 normal = (c[1] - c[0]).cross(c[2] - c[0]);
    for (const Index node : surface.nodes(t)) {
      if (static_cast<std::size_t>(node) >= normals.size())
        normals.resize(static_cast<std::size_t>(node) + 1, Vec3::Zero());
      normals[static_cast<std::size_t>(node)] += normal;
    }
  }
}

Real SurfaceSurface::edge_length() const {
  Real sum = 0;
  const Index count = second().triangles();
  for (Index t = 0; t < count; ++t) {
    const Corners c = second().now(t);
    sum += (c[1] - c[0]).norm() + (c[2] - c[1]).norm() + (c[0] - c[2]).norm();
  }
  return count > 0 ? sum / static_cast<Real>(3 * count) : 0;
}

void SurfaceSurface::find(const TouchedPlaces&, std::vector<Touch>& out) {
  first_.look();
  add_normals(first_, normals_first_);
  if (is_self_) {
    meet(first_, normals_first_, first_, 1, out);
  } else {
    second_.look();
    add_normals(second_, normals_second_);
    meet(first_, normals_first_, second_, 1, out);
    meet(second_, normals_second_, first_, -1, out);
  }
  drop_doubles(out);
}

void SurfaceSurface::meet(const MovingSurface& nodes, const std::vector<Vec3>& normals,
                          const MovingSurface& faces, Real sign, std::vector<Touch>& out) const {
  const Real edge = reach_ * edge_length();
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (normals[i].isZero(0)) continue;
    const auto node = static_cast<Index>(i);
    const Vec3 p = nodes.point(node), outward = normals[i].normalized();
    Box box;
    box.add(p);
    Touch best;
    Real least = std::numeric_limits<Real>::infinity();
    faces.near(box.grown(depth * edge), [&](Index t) {
      const auto& corners = faces.nodes(t);
      const bool own =
          &nodes == &faces && (corners[0] == node || corners[1] == node || corners[2] == node);
      const Vec3 n = faces.normal(t);
      if (own || n.dot(outward) > facing) return;
      const Corners c = faces.now(t);
      const TrianglePoint foot = closest_point(p, c);
      const Vec3 at = foot.on(c), apart = p - at;
      const Real height = n.dot(apart), distance = apart.norm();
      // Further beside the triangle nothing touches, however near: whether it does must not change
      // as the gap closes.
      if (distance > depth * edge || (apart - height * n).norm() > beside * edge) return;
      if (height > margin * edge) return;
      if (distance > least || (distance == least && t > best.triangle)) return;
      least = distance;
      best.first_place = static_cast<Real>(node);
      best.triangle = t;
      best.weights = foot.weights;
      best.normal = sign * n;
      best.along = n.unitOrthogonal();
      best.at = at;
      best.gap = height;
      if (foot.corner >= 0)
        best.second_place = static_cast<Real>(corners[static_cast<std::size_t>(foot.corner)]);
      else
        best.second_place = -1;
    });
    if (best.triangle < 0) continue;
    best.nodes_are_second = sign < 0;
    out.push_back(best);
  }
}

/// Two nodes at one place meet each other twice.
void SurfaceSurface::drop_doubles(std::vector<Touch>& out) const {
  std::erase_if(out, [&](const Touch& t) {
    if (t.second_place < 0) return false;
    for (const Touch& o : out)
      if (&o != &t && o.second_place == t.first_place && o.first_place == t.second_place &&
          (is_self_ || o.nodes_are_second != t.nodes_are_second) && o.first_place < t.first_place)
        return true;
    return false;
  });
}

Vec3 SurfaceSurface::slip(const Touch& t) const {
  const MovingSurface& nodes = t.nodes_are_second ? second() : first_;
  const MovingSurface& faces = t.nodes_are_second ? first_ : second();
  const Vec3 slip =
      nodes.moved(static_cast<Index>(t.first_place)) - faces.moved(t.triangle, t.weights);
  return t.nodes_are_second ? Vec3(-slip) : slip;
}

void SurfaceSurface::couple(const Touch& t, BlockId block, const Directions& axes,
                            ConstraintBuilder& builder) const {
  const MovingSurface& nodes = t.nodes_are_second ? second() : first_;
  const MovingSurface& faces = t.nodes_are_second ? first_ : second();
  const Directions on_nodes = t.nodes_are_second ? Directions(-axes) : axes;
  PointJacobian J;
  J.nodes = 1;
  J.width = 3;
  J.node[0] = static_cast<Index>(t.first_place);
  J.coefficients = Mat3::Identity();
  const auto couple_nodes = [&] { builder.couple(block, nodes.solid(), on_nodes, J, t.at); };
  PointJacobian K;
  faces.jacobian(t.triangle, t.weights, K);
  const auto couple_faces = [&] { builder.couple(block, faces.solid(), -on_nodes, K, t.at); };
  // The first coupling is that of the first body: its force is the one that is drawn.
  if (t.nodes_are_second)
    couple_faces(), couple_nodes();
  else
    couple_nodes(), couple_faces();
}

Pair::Tolerance SurfaceSurface::tolerance(const Touch&) const {
  return {0.5, std::numeric_limits<Real>::infinity()};
}

Real SurfaceSurface::distance() const {
  SurfaceSurface now(first_.solid(), second().solid());
  std::vector<Touch> touches;
  // Wider and wider, until something is in reach.
  for (; touches.empty() && now.reach_ < 1e3; now.reach_ *= 4) now.find(Nowhere(), touches);
  Real smallest = std::numeric_limits<Real>::infinity();
  for (const Touch& t : touches) smallest = std::min(smallest, t.gap);
  return smallest;
}

}  // namespace sutura::contact
