#include "surface_normals.h"

#include <algorithm>
#include <cmath>

namespace sutura::contact {

void SurfaceNormals::look(const MovingSurface& surface) {
  const auto n = static_cast<std::size_t>(surface.triangles());
  now_.resize(n), start_.resize(n);
  const auto normal = [](const Corners& c) {
    return Vec3((c[1] - c[0]).cross(c[2] - c[0])).normalized();
  };
  for (Index t = 0; t < surface.triangles(); ++t) {
    now_[static_cast<std::size_t>(t)] = normal(surface.now(t));
    start_[static_cast<std::size_t>(t)] = normal(surface.at_start(t));
  }
}

Vec3 SurfaceNormals::of_node(const MovingSurface& surface,
                             const MovingSurface::SurfaceNode& node) const {
  const Vec3 at = surface.point(node.node);
  Vec3 sum = Vec3::Zero();
  for (const Index t : surface.around(node)) {
    const auto& nodes = surface.nodes(t);
    const auto k = std::find(nodes.begin(), nodes.end(), node.node) - nodes.begin();
    const Vec3 u = surface.point(nodes[(k + 1) % 3]) - at,
               v = surface.point(nodes[(k + 2) % 3]) - at;
    sum += std::atan2(u.cross(v).norm(), u.dot(v)) * now(t);
  }
  return sum.normalized();
}

}  // namespace sutura::contact
