#include "cut_mesh.h"

#include <algorithm>
#include <map>
#include <set>

namespace sutura::tissue {
namespace {

Triangle face_of(const Tet& tet, std::size_t without) {
  Triangle face{};
  for (std::size_t k = 0, at = 0; k < 4; ++k)
    if (k != without) face[at++] = tet[k];
  std::sort(face.begin(), face.end());
  return face;
}

/// The tets at a node in the parts that hang together by faces which are not cut.
std::vector<std::vector<Index>> parts_at(Index node, std::vector<Index> around,
                                         const std::map<Triangle, std::vector<Index>>& beside,
                                         const std::vector<Tet>& tets) {
  std::vector<std::vector<Index>> parts;
  while (!around.empty()) {
    std::vector<Index> part{around.back()};
    around.pop_back();
    for (std::size_t next = 0; next < part.size(); ++next) {
      const Tet& tet = tets[static_cast<std::size_t>(part[next])];
      for (std::size_t k = 0; k < 4; ++k) {
        if (tet[k] == node) continue;  // the face across from the node
        for (const Index other : beside.at(face_of(tet, k))) {
          const auto found = std::find(around.begin(), around.end(), other);
          if (found == around.end()) continue;
          part.push_back(other);
          around.erase(found);
        }
      }
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace

Index cut_open(MeshData& mesh, const std::function<bool(const std::array<Vec3, 3>&)>& is_cut) {
  std::map<Triangle, std::vector<Index>> beside;  // the tets at a face, as long as it is whole
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (std::size_t k = 0; k < 4; ++k)
      beside[face_of(mesh.tets[t], k)].push_back(static_cast<Index>(t));
  const auto at = [&](Index i) { return mesh.points[static_cast<std::size_t>(i)]; };
  std::set<Index> nodes;
  Index cut = 0;
  for (auto& [face, tets] : beside) {
    if (tets.size() < 2 || !is_cut({at(face[0]), at(face[1]), at(face[2])})) continue;
    tets.clear();
    nodes.insert(face.begin(), face.end());
    ++cut;
  }
  std::map<Index, std::vector<Index>> around;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (const Index i : mesh.tets[t])
      if (nodes.contains(i)) around[i].push_back(static_cast<Index>(t));
  // Faces are known by the nodes of before, so the copies come when all parts are known.
  const std::vector<Tet> before = mesh.tets;
  for (const auto& [node, tets] : around) {
    const auto parts = parts_at(node, tets, beside, before);
    for (std::size_t p = 1; p < parts.size(); ++p) {
      const Index copy = static_cast<Index>(mesh.points.size());
      mesh.points.push_back(at(node));
      ++mesh.copied_nodes;
      for (const Index t : parts[p]) {
        Tet& tet = mesh.tets[static_cast<std::size_t>(t)];
        std::replace(tet.begin(), tet.end(), node, copy);
      }
    }
  }
  return cut;
}

}  // namespace sutura::tissue
