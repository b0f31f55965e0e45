#include "boundary.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "split_edges.h"
#include "sutura/geometry/poses.h"

namespace sutura::contact {

Real SolidBoundary::depth(const Vec3& p) const {
  if (!solid_.locate(p, Configuration::current)) return 0;
  constexpr Real anywhere = 1e6;  // m
  const auto near = solid_.closest_surface(p, anywhere, Configuration::current);
  return near ? std::abs(near->distance) : 0;
}

Real SolidBoundary::distance(const Vec3& p, Real reach) const {
  const auto near = solid_.closest_surface(p, reach, Configuration::current);
  return near ? std::abs(near->distance) : std::numeric_limits<Real>::infinity();
}

void SolidBoundary::couple(ConstraintBuilder& builder, BlockId block, const Directions& directions,
                           Index triangle, const Vec3& weights, const Vec3& at) const {
  PointJacobian J;
  solid_.jacobian(solid_.on_surface(triangle, weights), J);
  builder.couple(block, solid_, directions, J, at);
}

ToolBoundary::ToolBoundary(RigidTool& tool, Real longest) : tool_(tool) {
  mesh_ = {tool.mesh()->points(), tool.mesh()->triangles()};
  Box all;
  for (const Vec3& p : mesh_.points) all.add(p);
  constexpr Real most = 256;  // nodes along a tool: a large one with a node every so often is slow
  const Real shortest = (all.high - all.low).norm() / most;
  mesh_ = split_convex_edges(std::move(mesh_), std::max(longest, shortest));
}

Real ToolBoundary::signed_distance(const Vec3& p) const {
  return tool_.mesh()->signed_distance(seen_from(tool_.placed(Configuration::current), p));
}

TriangleSurface ToolBoundary::surface(Configuration c) const {
  Placed& placed = placed_[static_cast<std::size_t>(c)];
  const Pose frame = tool_.placed(c);
  const bool stays = placed.generation > 0 && frame.position == placed.frame.position &&
                     frame.rotation.coeffs() == placed.frame.rotation.coeffs();
  if (!stays) {
    placed.frame = frame;
    placed.generation = ++generation_;
    placed.positions.resize(3 * mesh_.points.size());
    Real* x = placed.positions.data();
    for (const Vec3& p : mesh_.points) {
      Eigen::Map<Vec3>{x} = at(frame, p);
      x += 3;
    }
  }
  return {mesh_.triangles, placed.positions, placed.generation};
}

Real ToolBoundary::depth(const Vec3& p) const {
  return std::max(Real(0), -signed_distance(p));
}

Real ToolBoundary::distance(const Vec3& p, Real reach) const {
  const Real distance = std::abs(signed_distance(p));
  return distance <= reach ? distance : std::numeric_limits<Real>::infinity();
}

}  // namespace sutura::contact
