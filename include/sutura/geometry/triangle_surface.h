// The boundary of a solid as triangles: what contact, viewers and haptics ask of a tissue.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sutura/body.h"

namespace sutura {

/// A boundary in one configuration. It is a view into the solid, cheap to ask for and to copy; its
/// positions are those of the moment of asking, until the solid moves.
struct TriangleSurface {
  /// Nodes, counterclockwise seen from outside, with the numbers that they have in the solid. They
  /// stay the same as long as the solid lives.
  std::span<const std::array<Index, 3>> triangles;
  std::span<const Real> positions;  ///< x, y, z of every node of the solid (m), not of these only
  /// Another number than at the last asking, in the same configuration: the positions may have
  /// changed, and boxes made of them have to be refitted.
  std::uint64_t generation = 0;

  Index size() const { return static_cast<Index>(triangles.size()); }
  Vec3 point(Index node) const {
    return Eigen::Map<const Vec3>(positions.data() + 3 * static_cast<std::ptrdiff_t>(node));
  }
  std::array<Vec3, 3> corners(Index triangle) const {
    const auto& t = triangles[static_cast<std::size_t>(triangle)];
    return {point(t[0]), point(t[1]), point(t[2])};
  }
  /// Outward, as long as twice the area (m^2).
  Vec3 area_normal(Index triangle) const {
    const std::array<Vec3, 3> t = corners(triangle);
    return (t[1] - t[0]).cross(t[2] - t[0]);
  }
};

/// A solid that is made of elements, and so has triangles on its boundary.
class MeshedSolid : public SolidBody {
 public:
  static constexpr const char* interface_name = "MeshedSolid";
  virtual TriangleSurface surface(Configuration c) const = 0;
  /// A point of a triangle as a point of the solid. `weights`: barycentric, one per node of it.
  virtual EmbeddedPoint on_surface(Index triangle, const Vec3& weights) const = 0;
};

}  // namespace sutura
