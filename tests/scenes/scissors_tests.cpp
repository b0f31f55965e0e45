// A thread that is cut: what hangs on it falls, what pulled at it pulls no more, and nothing of it
// stays in the gap.
#include <gtest/gtest.h>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

constexpr Real density = 910, young = 1.5e9, gravity = 9.81;  // of the thread, as by default

TEST(Scissors, WhatIsBelowFallsAndTheRestCarriesTheRest) {
  TextRun run = TextRun::file("components/Scissors.xml");
  run.run(0.1);
  EXPECT_EQ(run.number("/suture_thread", "cuts"), 0);
  const Real before = run.vector("/suture_thread", "end_position").z();
  run.run(0.3);
  EXPECT_EQ(run.number("/scissors", "cuts"), 1);
  EXPECT_EQ(run.number("/suture_thread", "cuts"), 1);
  // Implicit Euler falls h^2 g n (n + 1) / 2 in n steps, exactly; what hung there was stretched by
  // 5 nm, and is no more.
  constexpr Real h = 5e-3, n = 40;
  EXPECT_NEAR(run.vector("/suture_thread", "end_position").z(),
              before - h * h * gravity * n * (n + 1) / 2, 1e-8);
  // Twenty beams of 1 mm hang there, and half of the one that is cut; the strain is that in the
  // middle of the topmost.
  const Real strain = density * gravity * 20e-3 / young;
  EXPECT_NEAR(run.number("/suture_thread", "largest_strain"), strain, 1e-6 * strain);
  EXPECT_TRUE(run.simulation().report().solved);
}

constexpr const char* between_hands =
    "<SutureThread name='a' needle_length='0' thread_length='40 mm' thread_beams='40' "
    "tip_direction='-1 0 0' damping_stiffness='0.1 ms' STRENGTH/>"
    "<Track name='still' times='0' positions='0 0 0'/><Track name='way' times='0 0.2 s' "
    "positions='0 0 0  0.8 0 0 mm'/><Grasper name='left' at='0' track='still' "
    "rotation_stiffness='0'/><Grasper name='right' at='40 mm' track='way' "
    "rotation_stiffness='0'/>";
std::string hands(const std::string& strength) {
  std::string text = between_hands;
  return text.replace(text.find("STRENGTH"), 8, strength);
}
constexpr const char* settings = "dt='5 ms' gravity='0 0 0'";

TEST(Scissors, ATautThreadPullsNoMore) {
  TextRun run(
      hands("") + "<Scissors track='still' centre='20.5 0 0 mm' size='0.6 2 2 mm' times='0.25 s'/>",
      settings);
  ASSERT_TRUE(run) << run.said();
  run.run(0.2);
  EXPECT_GT(run.vector("/left", "force").norm(), 0.5);
  run.run(0.25);
  // The halves snap back and come to rest.
  run.run(1);
  EXPECT_EQ(run.number("/a", "cuts"), 1);
  EXPECT_LT(run.vector("/left", "force").norm(), 1e-3);
  EXPECT_LT(run.vector("/right", "force").norm(), 1e-3);
  EXPECT_TRUE(run.simulation().report().solved);
}

TEST(Scissors, AThreadTearsAtItsStrength) {
  TextRun run(hands("strength='0.3 N'"), settings);
  ASSERT_TRUE(run) << run.said();
  // Drawn by 2 % in 40 steps, EA = 36 N: 0.018 N more in each.
  Real most = 0;
  while (run.simulation().time() < 0.3) {
    run.simulation().step();
    most = std::max(most, run.vector("/right", "force").norm());
  }
  EXPECT_GT(most, 0.29);
  EXPECT_LT(most, 0.33);
  EXPECT_EQ(run.number("/a", "cuts"), 1);
}

TEST(Scissors, NothingTouchesWhatIsCut) {
  // A thread lies taut across another one, which is cut under it, and falls through the gap.
  const std::string two =
      "<plugin name='contact'/><SutureThread name='below' needle_length='0' tip='-20 0 0 mm' "
      "tip_direction='-1 0 0' thread_length='40 mm' thread_beams='41' clamp='both'/>"
      "<SutureThread name='above' needle_length='0' tip='0 -4 0.3 mm' tip_direction='0 -1 0' "
      "thread_length='8 mm' thread_beams='8'/><Contact first='above' second='below'/>";
  const char* falls = "dt='5 ms' gravity='0 0 -9.81'";
  TextRun held(two, falls),
      cut(two + "<Scissors body='below' size='0.5 2 2 mm' times='0.1 s'/>", falls);
  ASSERT_TRUE(held && cut) << held.said() << cut.said();
  held.run(0.3);
  cut.run(0.3);
  EXPECT_GT(held.vector("/above", "tip_position").z(), -2e-3);
  EXPECT_LT(cut.vector("/above", "tip_position").z(), -50e-3);
}

TEST(Scissors, RefuseAThreadThatIsSampledAnew) {
  TextRun run("<SutureThread sampling_angle='0.3'/><Scissors/>");
  EXPECT_FALSE(run);
  EXPECT_NE(run.said().find("sampling_angle"), std::string::npos) << run.said();
}

}  // namespace
}  // namespace sutura::testing
