// Meshes made in test code: grids of cubes, each cut into six tets around the diagonal from its
// lowest to its highest corner (Kuhn), as in the reference values.
#pragma once

#include <array>
#include <filesystem>
#include <fstream>
#include <iomanip>

#include "mesh_data.h"

namespace sutura::test {

using namespace tissue;

inline MeshData kuhn_block(std::array<int, 3> cells, const Vec3& size) {
  MeshData mesh;
  const auto number = [&](int i, int j, int k) {
    return static_cast<Index>((k * (cells[1] + 1) + j) * (cells[0] + 1) + i);
  };
  for (int k = 0; k <= cells[2]; ++k)
    for (int j = 0; j <= cells[1]; ++j)
      for (int i = 0; i <= cells[0]; ++i)
        mesh.points.push_back(
            Vec3(i * size[0] / cells[0], j * size[1] / cells[1], k * size[2] / cells[2]));
  static constexpr int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                       {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i)
        for (const auto& order : orders) {
          std::array<int, 3> at{i, j, k};
          Tet tet{number(i, j, k), 0, 0, 0};
          for (std::size_t c = 0; c < 3; ++c) {
            ++at[static_cast<std::size_t>(order[c])];
            tet[c + 1] = number(at[0], at[1], at[2]);
          }
          const auto& p = mesh.points;
          if (six_volume(p[tet[0]], p[tet[1]], p[tet[2]], p[tet[3]]) < 0) std::swap(tet[2], tet[3]);
          mesh.tets.push_back(tet);
        }
  mesh.region.assign(mesh.tets.size(), 0);
  return mesh;
}

inline VecX stacked(const std::vector<Vec3>& points) {
  VecX x(3 * static_cast<Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    x.segment<3>(3 * static_cast<Index>(i)) = points[i];
  return x;
}

/// For scenes in tests: a mesh file in Gmsh's format 2.2, with all digits.
inline void write_msh(const MeshData& mesh, const std::filesystem::path& file) {
  std::ofstream out(file);
  out << std::setprecision(17) << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n"
      << mesh.points.size() << "\n";
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    out << i + 1 << " " << mesh.points[i][0] << " " << mesh.points[i][1] << " " << mesh.points[i][2]
        << "\n";
  out << "$EndNodes\n$Elements\n" << mesh.tets.size() << "\n";
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    out << e + 1 << " 4 2 " << mesh.region[e] << " 1";
    for (const Index i : mesh.tets[e]) out << " " << i + 1;
    out << "\n";
  }
  out << "$EndElements\n";
}

}  // namespace sutura::test
