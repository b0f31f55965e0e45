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

}  // namespace sutura::testing
