// A closed line of few corners that is knotted as a closed line of many is.
#pragma once

#include <vector>

#include "sutura/types.h"

namespace sutura::testing {

/// Whether the edge from p to q goes through the triangle of a, b and c.
inline bool goes_through(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b,
                         const Vec3& c) {
  const auto volume = [](const Vec3& o, const Vec3& u, const Vec3& v, const Vec3& w) {
    return (u - o).dot((v - o).cross(w - o));
  };
  if ((volume(p, a, b, c) > 0) == (volume(q, a, b, c) > 0)) return false;
  const bool side = volume(p, q, a, b) > 0;
  return (volume(p, q, b, c) > 0) == side && (volume(p, q, c, a) > 0) == side;
}

/// A corner goes where the rest of the line does not lead through the triangle of it and its two
/// neighbours: then the line can be drawn straight there without passing through itself (Koniaris
/// and Muthukumar 1991, "Self-entanglement in ring polymers").
inline std::vector<Vec3> fewer_corners(std::vector<Vec3> line) {
  const auto can_go = [&](std::size_t i) {
    const std::size_t n = line.size(), before = (i + n - 1) % n, after = (i + 1) % n;
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t next = (j + 1) % n;
      const bool meets_a_corner = j == i || next == i || j == after || next == before;
      if (!meets_a_corner && goes_through(line[j], line[next], line[before], line[i], line[after]))
        return false;
    }
    return true;
  };
  for (std::size_t i = 0, kept = 0; kept < line.size() && line.size() > 4;) {
    i %= line.size();
    if (can_go(i)) {
      line.erase(line.begin() + static_cast<std::ptrdiff_t>(i));
      kept = 0;
    } else {
      ++i, ++kept;
    }
  }
  return line;
}

}  // namespace sutura::testing
