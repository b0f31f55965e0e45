#include "surface_normals.h"

#include <cmath>

namespace sutura::contact {

void SurfaceNormals::look(const MovingSurface& surface) {
  const auto n = static_cast<std::size_t>(surface.triangles());
  now_.resize(n), start_.resize(n);
  const auto& nodes = surface.surface_nodes();
  of_node_.assign(nodes.empty() ? 0 : static_cast<std::size_t>(nodes.back().node) + 1,
                  Vec3::Zero());
  const auto across = [](const Corners& c) { return Vec3((c[1] - c[0]).cross(c[2] - c[0])); };
  for (Index t = 0; t < surface.triangles(); ++t) {
    const auto i = static_cast<std::size_t>(t);
    const Corners c = surface.now(t);
    now_[i] = across(c).normalized();
    start_[i] = across(surface.at_start(t)).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 u = c[(k + 1) % 3] - c[k], v = c[(k + 2) % 3] - c[k];
      const Real angle = std::atan2(u.cross(v).norm(), u.dot(v));
      of_node_[static_cast<std::size_t>(surface.nodes(t)[k])] += angle * now_[i];
    }
  }
}

}  // namespace sutura::contact
