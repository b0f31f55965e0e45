// Rigid shapes by their signed distance. All but the plane are bounded, all are convex.
#pragma once

#include <vector>

#include "sutura/types.h"

namespace sutura::contact {

/// What a shape says of a point: how far from its surface, negative inside, and the outward unit
/// normal of the surface point closest to it.
struct ShapeDistance {
  Real distance = 0;  ///< m
  Vec3 normal = Vec3::UnitZ();
};

/// In a frame of its own: centre at the origin, axis along z (a plane: its normal).
struct Shape {
  enum class Kind { plane, sphere, capsule, cylinder, box };
  Kind kind = Kind::plane;
  Real radius = 0;               ///< of sphere, capsule, cylinder (m)
  Real half_length = 0;          ///< of the straight part of capsule and cylinder (m)
  Vec3 half_size{Vec3::Zero()};  ///< of the box (m)

  ShapeDistance at(const Vec3& p) const;
  /// Lines that show it, as pairs of points.
  std::vector<Vec3> wireframe() const;
};

}  // namespace sutura::contact
