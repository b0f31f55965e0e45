// Threads that hands move, at any step: no more strain than the tension explains, and every step
// solved. Once a grip's motion was taken for energy to be spent, and a braid stretched by 67 %.
#include <cmath>
#include <numbers>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

std::string settings(Real dt) {
  return "dt=\"" + std::to_string(1e3 * dt) + " ms\" gravity=\"0 0 -9.81\"";
}

/// 300 mm of 4-0 along x, straight, held at both ends: key frames of the two hands.
std::string held_thread(const std::string& left, const std::string& right) {
  return "<SutureThread name=\"suture\" needle_length=\"0\" tip=\"0 0 0\" tip_direction=\"-1 0 0\" "
         "thread_length=\"300 mm\" thread_beams=\"100\"/>"
         "<Track name=\"left\" " +
         left + "/><Track name=\"right\" " + right +
         "/>"
         "<Grasper name=\"a\" at=\"0\" track=\"left\"/>"
         "<Grasper name=\"b\" at=\"300 mm\" track=\"right\"/>";
}

struct Extremes {
  Real strain = 0, jaws = 0;
  int missed = 0;
};

Extremes extremes(TextRun& run, Real dt, Real duration) {
  Extremes e;
  for (int i = 0; i < std::lround(duration / dt); ++i) {
    e.missed += !run.simulation().step().solved;
    e.strain = std::max(e.strain, run.number("/suture", "largest_strain"));
    e.jaws = std::max(e.jaws, run.vector("/a", "force").norm());
  }
  return e;
}

/// A hand closes within a step, on a strand that another one holds, and draws on at 5 mm/s: the
/// strand is stretched by what the hand goes while it is closed, whatever the step.
class LateHand : public ::testing::TestWithParam<Real> {};

TEST_P(LateHand, StretchesByItsWayWhileClosed) {
  TextRun run(
      "<SutureThread name='suture' needle_length='0' tip_direction='-1 0 0' thread_length='100 mm' "
      "thread_beams='100'/><Track name='still' times='0'/>"
      "<Track name='way' times='0 1 s' positions='0 0 0  5 0 0 mm'/>"
      "<Grasper name='a' at='30 mm' track='still'/>"
      "<Grasper name='b' at='50 mm' track='way' grasp='0.1073 s'/>",
      "dt='" + std::to_string(1e3 * GetParam()) + " ms' gravity='0 0 0'");
  ASSERT_TRUE(run) << run.said();
  run.run(0.2);
  // EA of 4-0, and both grips give way: 1 kN/mm each, by default.
  constexpr Real EA = 36.08, length = 20e-3, grip = 1e6;
  const Real strain = 5e-3 * (0.2 - 0.1073) / length / (1 + 2 * EA / (length * grip));
  // The hand starts at once, so the strand still rings; that is below a thousandth.
  EXPECT_NEAR(run.number("/suture", "largest_strain"), strain, 2e-3 * strain);
  EXPECT_NEAR(run.vector("/b", "force").norm(), EA * strain, 2e-3 * EA * strain);
}

INSTANTIATE_TEST_SUITE_P(Steps, LateHand,
                         ::testing::Values(1e-3, 2.5e-3, 5e-3, 10e-3, 20e-3, 50e-3));

class MovingHands : public ::testing::TestWithParam<Real> {};

// The thread is swung to and fro at 1 m/s. It weighs 7 mg: its tension is of the order of 1 mN,
// against EA = 36 N. The bound is that of the first step at 1 ms, in which a hand comes 0.2 mm
// nearer and inertia still holds the thread straight.
TEST_P(MovingHands, SwingAThread) {
  TextRun run(
      held_thread("times=\"0 0.5 0.7 0.9 s\" positions=\"0 0 0 0 0 0 0 200 0 0 0 0 mm\"",
                  "times=\"0 0.5 0.7 0.9 s\" positions=\"0 0 0 -100 0 0 -100 200 0 -100 0 0 mm\""),
      settings(GetParam()));
  ASSERT_TRUE(run) << run.said();
  const Extremes e = extremes(run, GetParam(), 1.2);
  EXPECT_EQ(e.missed, 0);
  EXPECT_LT(e.strain, 1e-3);
}

// A hand takes the end of a soft braid 50 mm aside at 0.17 m/s. Braid and needle weigh 0.1 g: the
// jaws bear their weight and what starts them, 0.17 m/s in one step.
TEST_P(MovingHands, CarryASoftBraid) {
  TextRun run(
      "<SutureThread name=\"suture\" bending_factor=\"0.05\"/>"
      "<Track name=\"t\" times=\"0 0.3 s\" positions=\"0 0 0 0 50 0 mm\"/>"
      "<Grasper name=\"a\" at=\"10 mm\" track=\"t\"/>",
      settings(GetParam()));
  ASSERT_TRUE(run) << run.said();
  const Extremes e = extremes(run, GetParam(), 0.5);
  EXPECT_EQ(e.missed, 0);
  EXPECT_LT(e.strain, 1e-4);
  EXPECT_LT(e.jaws, 2e-4 * (9.81 + 0.17 / GetParam()));
}

// A straight thread pushed together by 2 mm is balanced under 0.24 N, and buckles. The arch that it
// becomes bears Euler's load, 4 pi^2 EI / L^2 = 30 uN: a strain of 1e-6.
TEST_P(MovingHands, PushAStraightThreadTogether) {
  TextRun run(held_thread("times=\"0 s\" positions=\"0 0 0 mm\"",
                          "times=\"0 0.1 s\" positions=\"0 0 0 -2 0 0 mm\""),
              "dt=\"" + std::to_string(1e3 * GetParam()) + " ms\"");
  ASSERT_TRUE(run) << run.said();
  const Extremes e = extremes(run, GetParam(), 0.3);
  EXPECT_EQ(e.missed, 0);
  EXPECT_LT(run.number("/suture", "largest_strain"), 1e-5);
}

// Likewise against forceps, whose rows push it all the time. Clamped at both ends and shortened by
// a tenth an elastica bears 1.05 times Euler's load 4 pi^2 EI / L^2. L begins at the last section
// that the forceps hold, 0.79 of the 2.5 mm that are between them.
TEST_P(MovingHands, PushAStraightThreadAgainstForceps) {
  TextRun run(
      "<SutureThread name='suture' needle_length='0' tip_direction='-1 0 0' "
      "plane_normal='0 0 1' thread_length='100 mm' thread_diameter='0.3 mm' thread_young='2 GPa' "
      "thread_density='1140' thread_beams='40' damping_mass='2'/>"
      "<Track name='still' times='0' positions='0 0 0'/>"
      "<Forceps track='still' centre='1 0 0 mm' axis='0 1 0' size='3 2 2 mm'/>"
      "<Track name='way' times='0 1' positions='0 0 0  -9.75 0 0 mm' easing='smooth'/>"
      "<Grasper name='hand' at='100 mm' track='way'/>",
      "dt='" + std::to_string(GetParam()) + "' gravity='0 0 0'");
  ASSERT_TRUE(run) << run.said();
  const Real length = 98.03e-3, bending = 2e9 * std::numbers::pi * std::pow(0.3e-3, 4) / 64;
  const Real load = 4 * std::pow(std::numbers::pi, 2) * bending / (length * length);
  run.run(0.5);  // the hand is half way, and has pushed the thread together by 5 %
  EXPECT_LT(run.vector("/hand", "force").norm(), 2 * load);
  run.run(3);
  // A hundredth for the next term of the elastica, and one for the step.
  EXPECT_NEAR(run.vector("/hand", "force").norm(), 1.05 * load, 0.02 * load);
}

INSTANTIATE_TEST_SUITE_P(Steps, MovingHands, ::testing::Values(1e-3, 2.5e-3, 5e-3, 10e-3, 20e-3));

// From half a turn on a rotation is the same as a shorter one the other way round.
TEST(MovingHands, ThatTurnByHalfATurnInAStepAreRefused) {
  const std::string turn = "times=\"0 1 s\" rotations=\"0 0 0  80 0 0\"",
                    rest = "times=\"0\" positions=\"0 0 0\"";
  EXPECT_TRUE(TextRun(held_thread(turn, rest), settings(0.02)));
  TextRun refused(held_thread(turn, rest), settings(0.05));
  EXPECT_FALSE(refused);
  EXPECT_NE(refused.said().find("turns by up to 4 rad in a step of 0.05 s"), std::string::npos)
      << refused.said();
}

}  // namespace
}  // namespace sutura::testing
