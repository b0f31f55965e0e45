// Points of the rod by abscissa: what CurveBody asks.
#pragma once

#include "cubic.h"
#include "rod.h"
#include "sutura/geometry/curve_segments.h"

namespace sutura::thread {

/// Beam and place within it.
struct CurvePlace {
  Index beam = 0;
  Real u = 0;  ///< in [0, 1]
};
CurvePlace place(const Rod& rod, Real s);

Vec3 curve_point(const Rod& rod, Real s, Configuration c);
Vec3 curve_tangent(const Rod& rod, Real s, Configuration c);
/// Section frame: the nodes' frames, with the twist between them spread evenly, x axis along the
/// tangent.
Pose curve_frame(const Rod& rod, Real s, Configuration c);
/// d point / d (x_a, spin_a, x_b, spin_b) of the beam.
void curve_jacobian(const Rod& rod, Real s, Configuration c, PointJacobian& out);
/// The same of the material point at `arm` (m, world axes) from the centre of the section. The
/// section turns as the tangent of the cubic does, and rolls as the nodes do, linearly between
/// them.
void curve_surface_jacobian(const Rod& rod, Real s, const Vec3& arm, PointJacobian& out);
/// How far the nodes beside s have rolled about their tangents in a `motion` from the start of the
/// step (see `turned`), by their shares there (rad): what section s has, to within half a turn.
Real coarse_curve_roll(const Rod& rod, Real s, const Dofs& motion);
/// The beams as segments.
void curve_segments(const Rod& rod, Configuration c, std::vector<CurveSegment>& out);
/// First local minimum of the distance to p met downhill from `guess` within [low, high].
Real curve_closest(const Rod& rod, const Vec3& p, Real guess, Real low, Real high, Configuration c);

/// Mean curvature of a beam, from its end tangents (1/m).
Real beam_curvature(const Rod& rod, Index beam);

}  // namespace sutura::thread
