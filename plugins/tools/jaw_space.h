// The space between open jaws, a box: what part of a thread or of a triangle is in it. All points
// are seen from the jaws: the centre of the box is the origin, they close along z.
#pragma once

#include <vector>

#include "sutura/geometry/curve_segments.h"
#include "sutura/geometry/distances.h"

namespace sutura::tools {

struct JawSpace {
  Vec3 half = Vec3::Zero();  ///< half of its edges (m)

  bool contains(const Vec3& p) const { return (p.cwiseAbs().array() <= half.array()).all(); }

  /// A stretch of a curve in the space.
  struct Stretch {
    Real low = 0, high = 0;  ///< abscissae (m)
    Vec3 middle = Vec3::Zero();
  };
  /// All of them, by growing abscissa. One that is shorter than half of the smallest edge of the
  /// box may be overlooked.
  void stretches(const std::vector<CurveSegment>& curve, std::vector<Stretch>& out) const;

  /// The part of a triangle in the space: its area (m^2), and the barycentric weights of its
  /// centroid in the triangle.
  struct Part {
    Real area = 0;
    Vec3 weights = Vec3::Zero();
  };
  Part part(const Corners& triangle) const;
};

/// A strand between the jaws, as a line of points at equal steps along it.
struct Strand {
  Index curve = 0;         ///< of which it is a part
  Real radius = 0;         ///< m
  Real low = 0, high = 0;  ///< abscissae of its ends (m)
  std::vector<Vec3> line;
};
/// How flat the strands can be pressed together along z before two of them meet, or one that has
/// turned back meets itself: a part of their heights. 0: nothing is in the way, 1: they touch now.
Real flattest(const std::vector<Strand>& strands);

}  // namespace sutura::tools
