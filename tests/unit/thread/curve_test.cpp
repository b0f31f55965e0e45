// What a curve says of its sections: by how much they have rolled.
#include "curve.h"

#include <gtest/gtest.h>

#include "divided_step.h"
#include "rod_builder.h"
#include "sutura/geometry/rolling.h"

namespace sutura::thread {
namespace {

// Nodes that roll by turns and tilt on the way; without tilt, sections between them by their share.
TEST(CurveRoll, CountsWholeTurns) {
  for (const Real turns : {0., 0.4, -3.3, 51.7})
    for (const Real tilt : {0., 0.3}) {
      Rod rod;
      rod.build(straight_layout(0.1, 4, nylon(), Vec3(1, 2, -1)));
      RodStep step(rod);
      step.begin(rod, 0.01, Vec3::Zero());
      const Vec3 along = Vec3(1, 2, -1).normalized(), across = along.unitOrthogonal();
      VecX motion = VecX::Zero(rod.dofs());
      const auto roll_of = [&](Real s) { return 2 * std::numbers::pi * turns + 30 * s; };
      for (Index i = 0; i < rod.nodes(); ++i) {
        motion.segment<3>(6 * i) = Vec3(0.01, 0, 0.02);
        motion.segment<3>(6 * i + 3) = roll_of(rod.abscissa()[i]) * along + tilt * across;
      }
      step.move_to(rod, motion);
      const auto rolled = [&](Real s) {
        return roll_like(roll_between(curve_frame(rod, s, Configuration::start).rotation,
                                      curve_frame(rod, s, Configuration::current).rotation),
                         coarse_curve_roll(rod, s, motion))
            .sum();
      };
      for (Index i = 0; i < rod.nodes(); ++i)
        EXPECT_NEAR(rolled(rod.abscissa()[i]), roll_of(rod.abscissa()[i]), 1e-11)
            << turns << ' ' << tilt;
      if (tilt != 0) continue;
      for (Real s = 0.005; s < 0.1; s += 0.01) EXPECT_NEAR(rolled(s), roll_of(s), 1e-11) << turns;
    }
}

}  // namespace
}  // namespace sutura::thread
