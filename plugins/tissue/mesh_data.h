// A tetrahedral mesh as read from a file: no physics.
#pragma once

#include <Eigen/LU>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "sutura/types.h"

namespace sutura::tissue {

using Tet = std::array<Index, 4>;
using Triangle = std::array<Index, 3>;

struct MeshData {
  std::vector<Vec3> points;  ///< m, once scaled
  std::vector<Tet> tets;
  std::vector<int> region;                  ///< one tag per tet; 0 where the file gives none
  std::map<int, std::string> region_names;  ///< of the tags that have one
  Index copied_nodes = 0;                   ///< that a cut has put where another one is
};

/// From the first corner of a tet to the three others, as columns (m).
inline Mat3 tet_edges(const Tet& t, const std::vector<Vec3>& points) {
  const auto at = [&](int c) {
    return points[static_cast<std::size_t>(t[static_cast<std::size_t>(c)])];
  };
  Mat3 out;
  for (int c = 0; c < 3; ++c) out.col(c) = at(c + 1) - at(0);
  return out;
}
/// The same of positions node by node.
inline Mat3 tet_edges(const Tet& t, const VecX& x) {
  const auto at = [&](int c) { return x.segment<3>(3 * t[static_cast<std::size_t>(c)]); };
  Mat3 out;
  for (int c = 0; c < 3; ++c) out.col(c) = at(c + 1) - at(0);
  return out;
}
/// F = dx/dX.
template <class Points>
Mat3 deformation_gradient(const Tet& t, const Points& rest, const VecX& now) {
  return tet_edges(t, now) * tet_edges(t, rest).inverse();
}

/// Six times the signed volume (m^3); positive if 1, 2, 3 turn counterclockwise seen from 0's far
/// side.
inline Real six_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

}  // namespace sutura::tissue
