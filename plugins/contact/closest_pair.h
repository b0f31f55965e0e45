// The closest points of two cubics.
#pragma once

#include "sutura/geometry/curve_segments.h"

namespace sutura::contact {

struct ClosestPair {
  Real u = 0, v = 0;  ///< in [0, 1], on the first and on the second
  Real distance = 0;  ///< m
  Vec3 apart;         ///< from the second to the first (m)
};

/// Of two segments: from the closest points of their chords (of several on each, where they bend
/// by more than a fraction of `fine`) by Newton. Of two places whose distances differ by less than
/// the chords leave out, a tenth of `fine` each, it may find the other one; else it is exact for
/// segments that bend by less than half a turn.
ClosestPair closest_on(const CurveSegment& a, const CurveSegment& b, Real fine);
/// The point of b that is closest to `p`; u stays as given.
ClosestPair closest_to(const Vec3& p, Real u, const CurveSegment& b);

}  // namespace sutura::contact
