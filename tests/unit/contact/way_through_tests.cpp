// How much of a way is free: against a wall at a known distance, and of ways that lead astray.
#include <gtest/gtest.h>

#include <limits>

#include "moving_curve.h"

namespace sutura::contact {
namespace {

TEST(WayThrough, EndsAtTheClearance) {
  // 1 m of way towards a wall at 0.7 m, a clearance of 0.1 m: free up to 0.6, to the bisection.
  const auto distance = [](Real time) { return std::abs(0.7 - time); };
  EXPECT_NEAR(way_through(1, 0.1, distance), 0.6, 1e-3);
  EXPECT_LE(way_through(1, 0.1, distance), 0.6);
  EXPECT_EQ(way_through(1, 0.1, [](Real time) { return 2 - time; }), 1);
}

// A guess that has gone astray is no reason to look for ever, nor to call its way free.
TEST(WayThrough, OfAWayThatLeadsAstrayIsShort) {
  constexpr Real infinity = std::numeric_limits<Real>::infinity();
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  EXPECT_EQ(way_through(infinity, 1e-4, [](Real) { return 1.; }), 0);
  EXPECT_EQ(way_through(nan, 1e-4, [](Real) { return 1.; }), 0);
  EXPECT_EQ(way_through(1, 1e-4, [&](Real) { return nan; }), 0);
  const Real far = way_through(1e12, 1e-4, [](Real) { return 2e-4; });
  EXPECT_GT(far, 0);
  EXPECT_LT(far, 1e-6);
}

}  // namespace
}  // namespace sutura::contact
