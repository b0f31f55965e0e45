// How far what turns is from its straight way: the height of a circular arc over its chord.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "bulge.h"

namespace sutura::contact {
namespace {

TEST(Bulge, IsTheHeightOfAnArc) {
  const Real R = 0.0186;  // m
  for (const Real angle : {1e-3, 0.25, 1., 2.5, 3.14})
    EXPECT_NEAR(arc_height(2 * R * std::sin(angle / 2), angle), R * (1 - std::cos(angle / 2)),
                1e-15 * R)  // rounding
        << angle;
  // Of more than half a turn nothing is known but where it began and ended.
  EXPECT_NEAR(arc_height(2 * R, 5), R, 1e-15 * R);
  EXPECT_EQ(arc_height(0, 5), 0);
}

}  // namespace
}  // namespace sutura::contact
