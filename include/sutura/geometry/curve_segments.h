// A curve as its segments: what contact, viewers and haptics ask of a thread.
#pragma once

#include <vector>

#include "sutura/body.h"

namespace sutura {

/// One stretch of a curve: the cubic through its ends, on which every point of the centreline
/// between them lies.
struct CurveSegment {
  Real from = 0, to = 0;  ///< abscissae of its ends (m)
  Vec3 xa, ma, xb, mb;    ///< ends, and tangents there times the length at rest (m)
  Real radius = 0;        ///< of the section (m)

  Real length() const { return to - from; }
  Real abscissa(Real u) const { return from + u * (to - from); }
  /// At u in [0, 1], from the first end to the second.
  Vec3 point(Real u) const {
    const Real v = 1 - u;
    return v * v * (1 + 2 * u) * xa + u * v * v * ma + u * u * (3 - 2 * u) * xb - u * u * v * mb;
  }
  /// d point / du
  Vec3 slope(Real u) const {
    const Real v = 1 - u;
    return 6 * u * v * (xb - xa) + v * (1 - 3 * u) * ma + u * (3 * u - 2) * mb;
  }
  /// d2 point / du2
  Vec3 second(Real u) const {
    return (6 - 12 * u) * (xb - xa) + (6 * u - 4) * ma + (6 * u - 2) * mb;
  }
};

/// A curve that is made of such segments: its tangent is continuous, its points and the surface
/// around them are known by abscissa.
class SegmentedCurve : public CurveBody {
 public:
  static constexpr const char* interface_name = "SegmentedCurve";
  /// All of them, by growing abscissa; `out` keeps its capacity.
  virtual void segments(Configuration c, std::vector<CurveSegment>& out) const = 0;
  /// As `jacobian`, of the material point that is away from the centre of section s by `arm` (m,
  /// world axes, at the guess). Exact for rigid motions, so that a force on it has its moment.
  virtual void surface_jacobian(Real s, const Vec3& arm, PointJacobian& out) const = 0;
};

}  // namespace sutura
