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

namespace {

TriangleData box(const Vec3& half_size) {
  TriangleData out;
  for (int i = 0; i < 8; ++i)
    out.points.push_back(
        half_size.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  out.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return out;
}

}  // namespace

bool ToolBoundary::has_sides(const RigidTool& tool) {
  return tool.mesh() != nullptr ||
         (tool.shape().kind == Shape::Kind::box && tool.shape().rounding == 0);
}

ToolBoundary::ToolBoundary(RigidTool& tool, Real longest) : tool_(tool) {
  const TriangleMesh* mesh = tool.mesh();
  mesh_ = mesh != nullptr ? TriangleData{mesh->points(), mesh->triangles()}
                          : box(tool.shape().half_size);
  mesh_ = split_convex_edges(std::move(mesh_), longest);
}

Real ToolBoundary::signed_distance(const Vec3& p) const {
  const Vec3 local = seen_from(tool_.placed(Configuration::current), p);
  return tool_.mesh() != nullptr ? tool_.mesh()->signed_distance(local)
                                 : tool_.shape().at(local).distance;
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
