// What the two VTK readers share: cell types and the names under which region tags are found.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_cursor.h"

namespace sutura::tissue {

inline constexpr int vtk_tetra = 10;
inline constexpr int vtk_quadratic_tetra = 24;

/// Cell data arrays read as region tags, in order of preference.
inline constexpr std::array<std::string_view, 5> region_array_names{
    "region", "gmsh:physical", "CellEntityIds", "medit:ref", "material"};

/// Place of `name` in the list, or its size: smaller is better.
inline std::size_t region_rank(std::string_view name) {
  std::size_t k = 0;
  while (k < region_array_names.size() && name != region_array_names[k]) ++k;
  return k;
}

/// The cells of a VTK mesh before the tets are picked out.
struct VtkCells {
  std::vector<long long> offsets;  ///< cells + 1, first 0, ascending
  std::vector<long long> connectivity;
  std::vector<long long> types;
  std::vector<double> region;  ///< per cell, or empty
};

/// Keeps the tets; faces, lines and points are left out. Throws FileProblem at `line` for a bad
/// index or any other volume.
void take_tets(const VtkCells& cells, int line, MeshData& mesh);

}  // namespace sutura::tissue
