// A tetrahedral mesh as read from a file: no physics.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "sutura/types.h"

namespace sutura {

using Tet = std::array<Index, 4>;
using Triangle = std::array<Index, 3>;

struct MeshData {
  std::vector<Vec3> points;  ///< m, once scaled
  std::vector<Tet> tets;
  std::vector<int> region;                  ///< one tag per tet; 0 where the file gives none
  std::map<int, std::string> region_names;  ///< of the tags that have one
};

/// Six times the signed volume (m^3); positive if 1, 2, 3 turn counterclockwise seen from 0's far
/// side.
inline Real six_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

}  // namespace sutura
