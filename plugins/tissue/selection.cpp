#include "selection.h"

#include <algorithm>

namespace sutura::tissue {

std::optional<CornerBox> box_of(const std::vector<Real>& numbers, const TetMesh& mesh,
                                std::string& error) {
  if (numbers.size() != 6) {
    error = "'box' has " + std::to_string(numbers.size()) + " numbers, expected 6: two corners";
    return {};
  }
  const Vec3 a(numbers[0], numbers[1], numbers[2]), b(numbers[3], numbers[4], numbers[5]);
  const Vec3 rounding = Vec3::Constant(1e-9 * (mesh.report().high - mesh.report().low).norm());
  return CornerBox{a.cwiseMin(b) - rounding, a.cwiseMax(b) + rounding};
}

std::optional<Selection> select(const TetMesh& mesh, const std::vector<Real>& box,
                                const std::string& region, std::string& error) {
  std::optional<CornerBox> bounds;
  if (!box.empty() && !(bounds = box_of(box, mesh, error))) return {};
  std::optional<int> tag;
  if (!region.empty() && !(tag = mesh.region(region, error))) return {};

  const MeshData& data = mesh.data();
  const auto inside = [&](const Vec3& p) { return !bounds || bounds->contains(p); };
  const auto of_region = [&](std::size_t tet) { return !tag || data.region[tet] == *tag; };
  Selection out;
  for (std::size_t e = 0; e < data.tets.size(); ++e) {
    if (!of_region(e)) continue;
    Vec3 middle = Vec3::Zero();
    for (const Index i : data.tets[e]) {
      middle += data.points[i] / 4;
      if (inside(data.points[i])) out.nodes.push_back(i);
    }
    if (inside(middle)) out.tets.push_back(static_cast<Index>(e));
  }
  std::sort(out.nodes.begin(), out.nodes.end());
  out.nodes.erase(std::unique(out.nodes.begin(), out.nodes.end()), out.nodes.end());
  for (const BoundaryFace& face : mesh.boundary()) {
    const bool all = std::all_of(face.nodes.begin(), face.nodes.end(),
                                 [&](Index i) { return inside(data.points[i]); });
    if (all && of_region(static_cast<std::size_t>(face.tet))) out.faces.push_back(face);
  }
  return out;
}

}  // namespace sutura::tissue
