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

/// The plane through a point of the surface; the shape, being convex, is behind it.
struct Facet {
  Vec3 normal;  ///< unit, outward
  Vec3 foot;    ///< m
};

/// In a frame of its own: centre at the origin, axis along z (a plane: its normal).
struct Shape {
  enum class Kind { plane, sphere, capsule, cylinder, box };
  Kind kind = Kind::plane;
  Real radius = 0;               ///< of sphere, capsule, cylinder (m)
  Real half_length = 0;          ///< of the straight part of capsule and cylinder (m)
  Vec3 half_size{Vec3::Zero()};  ///< of the box (m)
  Real rounding = 0;             ///< radius of its edges (m)

  ShapeDistance at(const Vec3& p) const;
  /// At the point of the surface closest to p.
  Facet facet(const Vec3& p) const {
    const ShapeDistance d = at(p);
    return {d.normal, p - d.distance * d.normal};
  }
  /// Without edges: all points of the surface are as far from a point or a line.
  bool is_round() const { return kind == Kind::sphere || kind == Kind::capsule; }
  /// The point closest to p of what is left without a layer of the surface (m): of round shapes the
  /// centre or the axis, whatever the layer. Not of a plane.
  Vec3 core(const Vec3& p, Real layer) const;
  /// The plane across the way from that point to p, through the face, edge or corner of the surface
  /// that the point is below. That of `facet` of round shapes, and where p is no further out.
  Facet facing(const Vec3& p, Real layer) const;
  /// From the middle to the nearest side (m); infinite for a plane.
  Real half_thickness() const;
  /// Lines that show it, as pairs of points.
  std::vector<Vec3> wireframe() const;
};

}  // namespace sutura::contact
