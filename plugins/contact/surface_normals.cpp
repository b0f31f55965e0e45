#include "surface_normals.h"

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
  const auto around = surface.around(node);
  const auto angles = surface.angles(node);
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < around.size(); ++i) sum += angles[i] * now(around[i]);
  return sum.normalized();
}

}  // namespace sutura::contact
