// A running suture (scenes/suture/running_tied.xml): five bites of one needle, its ends tied to
// each other over the wound by a surgeon's throw and one more (2 = 1), and cut.
#include <gtest/gtest.h>

#include "scenes/text_run.h"
#include "support/closed_line.h"
#include "support/fewer_corners.h"
#include "support/knot_type.h"

namespace sutura::testing {
namespace {

TEST(RunningSuture, FiveBitesAndAKnotHoldTheLipsTogetherWhenTheEndsAreCut) {
  TextRun world = TextRun::file("suture/running_tied.xml");
  const auto& thread = world.component<SegmentedCurve>("/suture");
  int steps = 0, missed = 0;
  const auto run = [&](Real until) {
    while (world.simulation().time() < until - 1e-9) {
      const StepReport& report = world.simulation().step();
      ASSERT_TRUE(report.finite);
      ++steps;
      missed += !report.solved || !report.faults.empty();
    }
  };
  const auto gap = [&] {
    return std::max({world.number("/gap_1", "distance"), world.number("/gap_2", "distance"),
                     world.number("/gap_3", "distance")});
  };
  const auto knot = [&](int part, int side) {
    return jones(fewer_corners(closed_to_the_sides(after_cuts(thread, part), side)));
  };
  constexpr Real rounding = 1e-6;
  run(5.2);
  // One bite: into a lip and out of it, into the other one and out of it.
  EXPECT_EQ(world.number("/puncture", "punctures"), 4);
  EXPECT_GT(gap(), 0.9e-3);  // 1 mm at rest, and nothing draws the lips together yet
  run(26);
  // Five bites are drawn tight one after the other, and what holds them is friction in the tissue.
  EXPECT_EQ(world.number("/puncture", "punctures"), 20);
  EXPECT_EQ(missed, 0);
  EXPECT_LT(gap(), 0.5e-3);
  run(28.6);
  // The needle is off, the strand is wound round the jaws, and the tail is not taken yet.
  EXPECT_EQ(world.number("/suture", "cuts"), 1);
  EXPECT_LT(std::abs(knot(1, 1) - 1.), rounding);
  run(31.4);
  // Two turns towards the hand's own side: a right-handed torus knot of five crossings.
  EXPECT_LT(std::abs(knot(1, 1) - jones_of_throw(5)), rounding);
  run(36.8);
  // The second throw is tied from the other side, so it is left-handed: a surgeon's knot.
  const Complex surgeons_knot = jones_of_throw(5) * std::conj(jones_of_throw(3));
  EXPECT_LT(std::abs(knot(1, -1) - surgeons_knot), rounding);
  run(37.85);
  // The ends were cut at 37.35 s, and all hands are away.
  EXPECT_EQ(world.number("/suture", "cuts"), 3);
  EXPECT_LT(std::abs(knot(2, -1) - surgeons_knot), rounding);
  const Real closed = gap();
  EXPECT_LT(closed, 0.5e-3);
  const int missed_before = missed;
  run(38.35);
  EXPECT_EQ(missed, missed_before);
  // It rests: it would creep by 50 um in 30 s at 1.7 um/s.
  EXPECT_NEAR(gap(), closed, 0.5 * 1.7e-6);
  EXPECT_EQ(world.number("/puncture", "punctures"), 20);
  EXPECT_EQ(world.number("/tight", "throws"), 2);
  std::printf("%d of %d steps missed their tolerance\n", missed, steps);
  EXPECT_LE(missed, steps / 100);
}

}  // namespace
}  // namespace sutura::testing
