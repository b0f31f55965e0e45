// A thread with a tight knot in it weighs a thousandth of the forces in the knot, and still falls
// and hangs as any other: touches of a thread with itself do not change its momentum.
#include <gtest/gtest.h>

#include <numbers>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

// The thread of the scene.
constexpr Real mass = std::numbers::pi * 0.1e-3 * 0.1e-3 * 1100 * 56.557e-3, gravity = 9.81;

/// Drawn together within 0.3 s, and then `released` by hands. The scene rests for 50 ms before.
TextRun drawn_together(const std::string& dt,
                       std::vector<std::pair<std::string, std::string>> released) {
  released.insert(released.end(), {{".dt", dt}, {".gravity", "0 0 -9.81"}});
  return TextRun::file("knots/overhand.xml", std::move(released));
}

class FreeKnot : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Steps, FreeKnot, ::testing::Values("2 ms", "5 ms", "10 ms"));

TEST_P(FreeKnot, FallsWithItsWeight) {
  TextRun run =
      drawn_together(GetParam(), {{"/left.release", "0.35 s"}, {"/right.release", "0.35 s"}});
  run.run(0.36);
  const Vec3 before = run.vector("/suture", "momentum");
  run.run(0.56);
  EXPECT_GT(run.number("/contact", "touches"), 0);
  const Vec3 gained = run.vector("/suture", "momentum") - before;
  const Vec3 due(0, 0, -mass * gravity * 0.2);
  // In every step a hundredth of the forces from outside may be left out: the tolerance.
  EXPECT_LT((gained - due).norm(), 0.01 * due.norm()) << gained.transpose();
}

TEST(FreeKnot, HangsStillByOneHand) {
  TextRun run =
      drawn_together("5 ms", {{"/right.release", "0.35 s"}, {"/suture.damping_mass", "20 1/s"}});
  run.run(2);
  EXPECT_GT(run.number("/contact", "touches"), 0);
  const Vec3 force = run.vector("/left", "force");
  EXPECT_LT((force - Vec3(0, 0, mass * gravity)).norm(), 0.01 * mass * gravity)
      << force.transpose();
  // With that drag it has come to rest; a pendulum of its length would swing with 0.7 m/s.
  EXPECT_LT((run.vector("/suture", "momentum") / mass).norm(), 1e-3);
}

}  // namespace
}  // namespace sutura::testing
