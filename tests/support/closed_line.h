// A thread whose ends go on to the sides for ever, as a closed line.
#pragma once

#include "stability/contact/crossings.h"

namespace sutura::testing {

/// Abscissa 0 goes on to the left (-x), the end to the right, and they meet high above.
inline Line closed_to_the_sides(const SegmentedCurve& curve, int parts) {
  Line line = line_of(curve, parts);
  constexpr Real far = 1;  // m
  const Vec3 first = line.front() - far * Vec3::UnitX(), last = line.back() + far * Vec3::UnitX();
  line.push_back(last);
  line.push_back(last + far * Vec3::UnitZ());
  line.push_back(first + far * Vec3::UnitZ());
  line.push_back(first);
  return line;
}

}  // namespace sutura::testing
