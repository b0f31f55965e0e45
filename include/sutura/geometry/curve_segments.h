// A curve as its segments: what contact, viewers and haptics ask of a thread.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "sutura/body.h"

namespace sutura {

/// One stretch of a curve: the cubic through its ends, on which every point of the centreline
/// between them lies.
struct CurveSegment {
  Real from = 0, to = 0;  ///< abscissae of its ends (m)
  Vec3 xa, ma, xb, mb;    ///< ends, and tangents there times the length at rest (m)
  Real radius = 0;        ///< of the section (m)
  Index rigid = -1;       ///< which rigid body it is part of; -1: none
  bool cut = false;       ///< bears and touches nothing; its points are far from everything

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
  /// By about how much section s has rolled about its tangent from the start of the step to the
  /// guess (rad, off by less than half a turn). It says how many whole turns that are: a thin
  /// thread that rolls on something does many in a step. The rest is told by rotations (`roll`).
  virtual Real coarse_roll(Real s) const = 0;
};

/// A curve stretches of which may move as rigid bodies for a while. Between two steps.
class RigidStretches {
 public:
  static constexpr const char* interface_name = "RigidStretches";
  virtual ~RigidStretches() = default;
  /// Where a stretch between these abscissae would begin and end: at segments that contain them.
  /// Of segments that bear nothing (cut) and of such that are rigid already, none.
  virtual std::optional<std::pair<Real, Real>> rigid_range(Real from, Real to) const = 0;
  /// The segments between two ends that `rigid_range` gave keep their shape from now on. Stretches
  /// of the same `body` are not held together by the curve: who makes them so does that.
  virtual void make_rigid(Index body, Real from, Real to) = 0;
  /// All stretches of that body are as free as before, with the forces in them that they had then.
  virtual void release(Index body) = 0;
  /// Whether there is such a body still: what is cut is rigid no more.
  virtual bool is_rigid(Index body) const = 0;
  /// What the segment that ends at s, or the one that begins there, exerts on what is beyond its
  /// end s, at the end of the last step (N; N m about the centre of the section). Zero where the
  /// curve ends.
  virtual Wrench end_wrench(Real s, bool of_the_one_before) const = 0;
};

}  // namespace sutura
