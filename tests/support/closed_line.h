// A thread whose ends go on to the sides for ever, as a closed line.
#pragma once

#include "stability/contact/crossings.h"

namespace sutura::testing {

/// Abscissa 0 goes on to the left (-x), the end to the right, and they meet high above; `side` -1:
/// the other way round.
inline Line closed_to_the_sides(Line line, int side = 1) {
  const Real far = side;  // m
  const Vec3 first = line.front() - far * Vec3::UnitX(), last = line.back() + far * Vec3::UnitX();
  line.push_back(last);
  line.push_back(last + Vec3::UnitZ());
  line.push_back(first + Vec3::UnitZ());
  line.push_back(first);
  return line;
}

inline Line closed_to_the_sides(const SegmentedCurve& curve, int parts, int side = 1) {
  return closed_to_the_sides(line_of(curve, parts), side);
}

/// Of a thread that is cut, the part after so many cuts, up to the next.
inline Line after_cuts(const SegmentedCurve& curve, int number) {
  std::vector<CurveSegment> segments;
  curve.segments(Configuration::current, segments);
  Line line;
  int cuts = 0;
  for (const CurveSegment& s : segments) {
    cuts += s.radius == 0;  // a beam that is cut is nowhere
    if (cuts == number && s.radius > 0) {
      if (line.empty()) line.push_back(s.xa);
      line.push_back(s.point(0.5));
      line.push_back(s.xb);
    }
  }
  return line;
}

}  // namespace sutura::testing
