// Jaws that turn a thread about itself: what a section has rolled is known with its whole turns, by
// a spring (Grasper) and by rows (Forceps), and roll is solved as well as what is across it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

constexpr Real turn = 2 * std::numbers::pi;

std::string settings_of(Real dt) {
  return "dt='" + std::to_string(dt) + "' gravity='0 0 0'";
}

constexpr const char* thread =
    "<SutureThread name='a' needle_length='0' tip_direction='-1 0 0' thread_length='100 mm' "
    "thread_diameter='0.3 mm' thread_beams='20'/><ThreadProbe name='middle' at='50 mm'/>";

class TurningHands : public ::testing::TestWithParam<Real> {};

// Let go with 0.7 turns in it, the end rolls back by whole turns in a step. When the hand takes it
// again the step before is no guess of what is to come: the end would roll on, be where it was
// after whole turns, and be wound for ever.
TEST_P(TurningHands, TakeAThreadThatSpinsBack) {
  TextRun run(std::string(thread) +
                  "<Track name='still' times='0' positions='0 0 0'/>"
                  "<Grasper name='left' at='0' track='still'/>"
                  "<Track name='way' times='0 0.5 s' rotations='0 0 0  250 0 0 deg'/>"
                  "<Grasper name='right' at='100 mm' track='way' grasp='0 0.605 s' "
                  "release='0.6 s'/>",
              settings_of(GetParam()));
  ASSERT_TRUE(run) << run.said();
  run.run(0.5);
  // Twist is alike all along once it has spread.
  EXPECT_NEAR(run.number("/middle", "twist") * 0.1, 250. / 360 * turn, 1e-2);
  run.run(0.8);
  const Real held = run.number("/middle", "twist");
  // It was free to unwind, and swing to the other side, but nothing has wound it further.
  EXPECT_LT(std::abs(held) * 0.1, 250. / 360 * turn);
  run.run(1.6);
  EXPECT_NEAR(run.number("/middle", "twist") * 0.1, held * 0.1, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Steps, TurningHands, ::testing::Values(1e-3, 2.5e-3, 5e-3, 10e-3, 20e-3));

// The hand turns by so much in one step, and back in the next one: after the first the thread rolls
// on in the guess, by nearly half a turn beyond the hand.
TEST(TurningHands, ThereAndBackInTwoSteps) {
  for (const std::string jaws :
       {"<Grasper at='90 mm' track='way'/>",
        "<Forceps track='way' centre='90 0 0 mm' axis='0 1 0' size='2 2 2 mm'/>"})
    for (const char* degrees : {"60", "91", "100", "150", "170"}) {
      TextRun run(std::string(thread) +
                      "<Track name='still' times='0' positions='0 0 0'/>"
                      "<Grasper name='left' at='0' track='still'/>"
                      "<Track name='way' times='0.5 0.55 0.6 s' rotations='0 0 0  " +
                      degrees + " 0 0  0 0 0 deg'/>" + jaws,
                  settings_of(50e-3));
      ASSERT_TRUE(run) << run.said();
      run.run(2);
      EXPECT_NEAR(run.number("/middle", "twist") * 0.09, 0, 1e-6) << jaws << degrees;
    }
}

// A grip that gives way and the thread are two torsion springs in series: M = angle / (1 / k + L /
// GJ), with GJ = G pi d^4 / 32. At a lag of whole turns the rotation from section to target is
// none, and a rotation vector that is counted by its length had no axis to count along: of five
// turns two got lost.
TEST(TurningHands, ASoftGripIsTurnedPastHalfATurn) {
  constexpr Real k = 1e-7, length = 0.05, diameter = 0.2e-3;
  constexpr Real shear = 1.5e9 / (2 * 1.4);
  const Real torsion = shear * std::numbers::pi * std::pow(diameter, 4) / 32;
  for (const Real degrees : {150., 250., 1000., 1800.}) {
    TextRun run(
        "<SutureThread name='a' needle_length='0' tip_direction='-1 0 0' thread_length='50 mm' "
        "thread_diameter='0.2 mm' thread_beams='20' thread_young='1.5 GPa' thread_poisson='0.4' "
        "clamp='start'/><Track times='0 1 s' rotations='0 0 0  " +
            std::to_string(degrees) +
            " 0 0 deg'/><Grasper name='jaws' at='50 mm' rotation_stiffness='1e-7'/>",
        settings_of(10e-3));
    ASSERT_TRUE(run) << run.said();
    run.run(3);
    const Real expected = degrees / 360 * turn / (1 / k + length / torsion);
    EXPECT_NEAR(run.vector("/jaws", "moment").x(), expected, 1e-3 * expected) << degrees;
  }
}

// Fine threads drawn taut across their grips: the force times a beam's length is thousands of
// times GJ over it. Twisted by 20 degrees, they have that twist all along.
TEST(TurningHands, FineTautThreadsAreTwistedAllAlong) {
  struct Case {
    const char *diameter, *young, *bending;
  };
  for (const Case& c :
       {Case{"0.02 mm", "2.7 GPa", "1"}, {"0.03 mm", "2.5 GPa", "1"}, {"0.07 mm", "5 GPa", "0.05"}})
    for (const Real dt : {5e-3, 10e-3, 20e-3}) {
      TextRun run(
          std::string("<SutureThread name='a' needle_length='0' tip_direction='-1 0 0' "
                      "thread_length='60 mm' thread_beams='30' thread_density='1100' "
                      "thread_diameter='") +
              c.diameter + "' thread_young='" + c.young + "' bending_factor='" + c.bending +
              "'/><Track name='still' times='0' positions='0 0 0'/>"
              "<Grasper name='left' at='0' track='still'/>"
              "<Track name='way' times='0 0.5 0.9 s' positions='0 0 0  -60 49.44 5  -60 61.8 0 mm' "
              "rotations='0 0 0  0 0 0  20 0 0 deg' centre='60 0 0 mm' easing='smooth'/>"
              "<Grasper name='right' at='60 mm' track='way'/><ThreadProbe name='first' at='1 mm'/>"
              "<ThreadProbe name='middle' at='30 mm'/><ThreadProbe name='last' at='59 mm'/>",
          settings_of(dt));
      ASSERT_TRUE(run) << run.said();
      run.run(2);
      for (const char* probe : {"/first", "/middle", "/last"})
        EXPECT_NEAR(run.number(probe, "twist") * 0.06, 20. / 360 * turn, 0.02)
            << probe << ", " << c.diameter << ", " << dt;
    }
}

}  // namespace
}  // namespace sutura::testing
