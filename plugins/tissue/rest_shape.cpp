#include "rest_shape.h"

#include <cstring>

#include "sutura/cache.h"

namespace sutura::tissue {
namespace {

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// A mesh as it was read.
struct MeshKey {
  MeshData mesh;
  bool assumed_metres;
  bool operator==(const MeshKey& other) const {
    return assumed_metres == other.assumed_metres && same_bits(mesh.points, other.mesh.points) &&
           same_bits(mesh.tets, other.mesh.tets) && mesh.region == other.mesh.region &&
           mesh.region_names == other.mesh.region_names &&
           mesh.copied_nodes == other.mesh.copied_nodes;
  }
};

}  // namespace

std::shared_ptr<const RestShape> rest_shape(MeshData mesh, bool assumed_metres, Cache* cache) {
  const auto make = [&mesh, assumed_metres]() -> std::shared_ptr<const RestShape> {
    auto out = std::make_shared<RestShape>();
    out->mesh = mesh;
    out->checked = check_mesh(out->mesh, assumed_metres);
    if (out->checked.error.empty())
      out->topology =
          std::make_shared<SolidTopology>(out->mesh.points, out->mesh.tets, out->checked.boundary);
    return out;
  };
  return cached(cache, MeshKey{mesh, assumed_metres}, make);
}

}  // namespace sutura::tissue
