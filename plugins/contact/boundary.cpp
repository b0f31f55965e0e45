#include "boundary.h"

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

ToolBoundary::ToolBoundary(RigidTool& tool, Real longest)
    : tool_(tool),
      mesh_(split_convex_edges({tool.mesh()->points(), tool.mesh()->triangles()}, longest)) {}

TriangleSurface ToolBoundary::surface(Configuration c) const {
  std::vector<Real>& positions = positions_[static_cast<std::size_t>(c)];
  positions.resize(3 * mesh_.points.size());
  const Pose frame = tool_.placed(c);
  Real* x = positions.data();
  for (const Vec3& p : mesh_.points) {
    Eigen::Map<Vec3>{x} = at(frame, p);
    x += 3;
  }
  return {mesh_.triangles, positions, ++generation_};
}

Real ToolBoundary::depth(const Vec3& p) const {
  const Vec3 local = seen_from(tool_.placed(Configuration::current), p);
  return std::max(Real(0), -tool_.mesh()->signed_distance(local));
}

Real ToolBoundary::distance(const Vec3& p, Real reach) const {
  const Vec3 local = seen_from(tool_.placed(Configuration::current), p);
  const Real distance = std::abs(tool_.mesh()->signed_distance(local));
  return distance <= reach ? distance : std::numeric_limits<Real>::infinity();
}

}  // namespace sutura::contact
