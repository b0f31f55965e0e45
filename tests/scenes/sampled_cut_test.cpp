// A thread that is sampled anew and cut: what it loses is one of its shortest beams, and both
// pieces go on being sampled.
#include <gtest/gtest.h>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

// The cut beam is 0.5 mm long: beams of 8 mm are halved until they are shorter than 0.9 mm.
constexpr const char* coarse = " thread_beams='5' sampling_angle='0.2' shortest_beam='0.45 mm'";

TEST(SampledCut, WhatIsBelowFallsAndTheRestCarriesTheRest) {
  constexpr Real density = 910, young = 1.5e9, gravity = 9.81, h = 5e-3, n = 40;
  TextRun run(
      "<SutureThread name='a' needle_length='0' tip_direction='0 0 1' plane_normal='0 1 0' "
      "thread_length='40 mm' clamp='start'" +
          std::string(coarse) +
          "/><Scissors centre='0 0 -20.4 mm' axis='1 0 0' size='2 2 1 mm' times='0.1 s'/>",
      "dt='5 ms' gravity='0 0 -9.81'");
  ASSERT_TRUE(run) << run.said();
  run.run(0.1);
  const Real before = run.vector("/a", "end_position").z();
  run.run(0.3);
  EXPECT_EQ(run.number("/a", "cuts"), 1);
  // What implicit Euler falls in n steps: beams that are merged on the way change nothing of it.
  EXPECT_NEAR(run.vector("/a", "end_position").z(), before - h * h * gravity * n * (n + 1) / 2,
              1e-8);
  // The topmost beam is still 8 mm long, and the cut one goes from 20 to 20.5 mm: half of it hangs
  // at the upper piece.
  const Real strain = density * gravity * (20.25e-3 - 4e-3) / young;
  EXPECT_NEAR(run.number("/a", "largest_strain"), strain, 1e-6 * strain);
  EXPECT_EQ(run.simulation().report().missed_steps, 0);
}

TEST(SampledCut, TheHalvesOfALoopSpringOpen) {
  // A hand turns the end of the thread round to where it begins, 10 mm above, the bend is cut, and
  // the pieces come to rest: each straight in the direction in which it is held.
  TextRun run(
      "<SutureThread name='a' needle_length='0' tip_direction='-1 0 0' "
      "plane_normal='0 0 1' thread_length='40 mm' damping_mass='50 1/s' "
      "damping_stiffness='1 ms'" +
          std::string(coarse) +
          "/><Track name='still' times='0' positions='0 0 0'/>"
          "<Track name='way' centre='40 0 0 mm' times='0 0.5 s' positions='0 0 0  -40 10 0 "
          "mm' rotations='0 0 0  0 0 180 deg'/>"
          "<Grasper name='left' at='0' track='still'/>"
          "<Grasper name='right' at='40 mm' track='way'/>"
          "<ThreadProbe name='upto' at='20 mm'/><ThreadProbe name='from' at='20.5 mm'/>"
          "<Scissors track='still' centre='15 5.2 0 mm' size='15 2 2 mm' times='0.6 s'/>",
      "dt='5 ms' gravity='0 0 0'");
  ASSERT_TRUE(run) << run.said();
  run.run(0.6);
  EXPECT_GT(run.number("/a", "beams"), 30);  // as the bend asks for
  run.run(2);
  EXPECT_EQ(run.number("/a", "cuts"), 1);
  EXPECT_LT((run.vector("/upto", "position") - Vec3(20e-3, 0, 0)).norm(), 1e-6);
  EXPECT_LT((run.vector("/from", "position") - Vec3(19.5e-3, 10e-3, 0)).norm(), 1e-6);
  EXPECT_EQ(run.simulation().report().missed_steps, 0);
  // What the bend alone asked for has been merged again, but for the neighbours of the cut beam.
  EXPECT_LT(run.number("/a", "beams"), 20);
}

// A thread without weight hangs from a hand; 0.1 mN draw at its end and 1 mN above the cut. What is
// cut off has to get 0.1 mN times the time since then, whatever the order in which drivers speak:
// scissors split beams while loads are being told.
TEST(SampledCut, LoadsStayWhereTheyAre) {
  const std::string end = "<ThreadLoad name='below' at='40 mm' force='0 0 -0.1 mN'/>",
                    above = "<ThreadLoad name='above' at='6 mm' force='0 0 -1 mN'/>",
                    blades =
                        "<Scissors track='still' centre='0 0 -10.2 mm' axis='1 0 0' "
                        "size='20 20 1 mm' times='0.1 s'/>";
  for (const std::string& drivers : {end + blades + above, blades + end + above}) {
    TextRun run(
        "<SutureThread name='a' needle_length='0' tip_direction='0 0 1' plane_normal='0 1 0' "
        "thread_length='40 mm' thread_diameter='0.2 mm' thread_density='1000'" +
            std::string(coarse) +
            "/><Track name='still' times='0'/><Grasper name='hand' at='0' track='still'/>" +
            drivers + "<EnergyProbe name='energy' body='a'/>",
        "dt='20 ms' gravity='0 0 0'");
    ASSERT_TRUE(run) << run.said();
    run.run(0.1);
    run.run(0.12);
    EXPECT_EQ(run.number("/a", "cuts"), 1);
    EXPECT_NEAR(run.vector("/hand", "force").z(), 1e-3, 1e-9);  // and not what was below
    run.run(0.2);
    const Real p = 1e-4 * 0.1, mass = 1000 * 3.1416e-8 * 29.8e-3;
    EXPECT_NEAR(run.vector("/a", "momentum").z(), -p, 1e-5 * p);  // what is above trembles still
    // Implicit Euler makes (n + 1) / n of the work in n = 5 steps. Half of a cut beam is 1 % of m.
    const Real work = 1.2 * p * p / (2 * mass);
    EXPECT_NEAR(run.number("/energy", "work_of_loads"), work, 0.02 * work);
    EXPECT_EQ(run.simulation().report().missed_steps, 0);
  }
}

// Beams of 0.01 mm, as blades leave them, are stiff: what rounds their forces is more than what is
// at work in a piece that falls. Beside a cut beam only the other one says how much that is.
TEST(SampledCut, PiecesThatFallAreBalanced) {
  std::string blades;
  for (int i = 0; i < 8; ++i)
    blades += "<Scissors name='c" + std::to_string(i) + "' centre='0 0 " +
              std::to_string(-2.2 - 1.1 * i) +
              " mm' axis='1 0 0' size='20 20 0.5 mm' times='0.1 s'/>";
  TextRun run(
      "<SutureThread name='a' needle_length='0' tip_direction='0 0 1' plane_normal='0 1 0' "
      "thread_length='40 mm' thread_beams='40' clamp='start' sampling_angle='0.2' "
      "shortest_beam='0.01 mm' damping_mass='20 1/s'/>" +
          blades + "<ThreadLoad at='40 mm' force='0 0 -0.1 mN' moment='0 1e-7 0'/>",
      "dt='5 ms' gravity='0 0 -9.81'");
  ASSERT_TRUE(run) << run.said();
  Index most = 0;
  for (int i = 0; i < 40; ++i) most = std::max(most, run.simulation().step().passes);
  // All of these blades reach over the same 20 mm: the second pair cuts both pieces, and so on.
  EXPECT_EQ(run.number("/a", "cuts"), 255);
  EXPECT_EQ(run.simulation().report().missed_steps, 0);
  EXPECT_LE(most, 5);
}

}  // namespace
}  // namespace sutura::testing
