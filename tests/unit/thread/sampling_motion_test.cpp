// Splits and merges of a thread in motion.
#include <gtest/gtest.h>

#include <cmath>

#include "divided_step.h"
#include "sampling_events.h"

namespace sutura::thread {
namespace {

constexpr Real length = 0.3;

/// Asked, per event: energy below 1 % of the bending energy of the beams concerned, and momenta to
/// 1e-10. A clamp that must not move takes what interpolation loses of those.
void expect_small(const Jumps& jumps, bool clamped) {
  EXPECT_GT(jumps.splits, 5);
  EXPECT_GT(jumps.merges, 5);
  EXPECT_LT(jumps.split, 0.01);
  EXPECT_LT(jumps.merge, 0.01);
  const Real lost = clamped ? 1e-4 : 1e-10;
  EXPECT_LT(jumps.momentum, lost);
  EXPECT_LT(jumps.angular_momentum, lost);
  // One event may not feed the motion: a thousand of them at this bound would gain a tenth.
  EXPECT_LT(jumps.kinetic, 1e-4);
}

Jumps follow(Rod& rod, Real dt, const Vec3& gravity, int steps) {
  Jumps jumps;
  RodStep step(rod);
  int unsolved = 0;
  for (int i = 0; i < steps; ++i) {
    if (!divided_step(rod, step, dt, gravity)) ++unsolved;
    if (resample_and_compare(rod, {.angle = 0.2, .shortest = 0.5e-3, .longest = 15e-3}, jumps))
      step.fit(rod);
  }
  EXPECT_EQ(unsolved, 0) << "steps of " << steps;
  return jumps;
}

TEST(SamplingInMotion, AThreadThatFallsSwingsAndCurls) {
  for (const Real dt : {5e-3, 1e-3}) {
    Rod rod;
    rod.build(straight_layout(length, 20, nylon()));
    rod.clamp(0);
    const Jumps jumps = follow(rod, dt, Vec3(0, 0.3, -9.81), static_cast<int>(4 / dt));
    std::printf("falling, %g ms: %s\n", 1e3 * dt, jumps.text().c_str());
    expect_small(jumps, true);
  }
}

TEST(SamplingInMotion, AThreadThrownInWaves) {
  for (const Real dt : {5e-3, 1e-3}) {
    Rod rod;
    rod.build(straight_layout(length, 20, nylon()));
    // Waves of 2 m/s, sections spinning with them and about the thread.
    for (Index i = 0; i < rod.nodes(); ++i) {
      const Real x = rod.abscissa()[i];
      rod.velocity().segment<3>(6 * i) = Vec3(0, 2 * std::sin(40 * x), 2 * std::cos(30 * x));
      rod.velocity().segment<3>(6 * i + 3) = Vec3(50, 60 * std::sin(30 * x), 80 * std::cos(40 * x));
    }
    const Jumps jumps = follow(rod, dt, Vec3::Zero(), static_cast<int>(2 / dt));
    std::printf("thrown, %g ms: %s\n", 1e3 * dt, jumps.text().c_str());
    expect_small(jumps, false);
  }
}

}  // namespace
}  // namespace sutura::thread
