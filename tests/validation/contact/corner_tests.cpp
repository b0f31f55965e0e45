// A thread that is drawn round a corner by much more than the corner in a step.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

constexpr Real load = 0.05, mu = 0.1;

/// Drawn over the edge of a bar, rounded with 0.4 mm, at 0.6 m/s, against 50 mN at its other end.
constexpr const char* scene = R"(
  <plugin name="contact"/>
  <SutureThread name="suture" needle_length="0" thread_young="2 GPa" thread_density="1100"
                thread_diameter="0.2 mm" bending_factor="0.015" thread_length="150 mm"
                thread_beams="300" damping_stiffness="0.1 ms" damping_mass="5 1/s"
                tip="10 0 2.1 mm" tip_direction="1 0 0" plane_normal="0 1 0"/>
  <Tool name="bar" shape="box" size="400 20 4 mm" rounding="0.4 mm" centre="-190.5 0 0 mm"/>
  <Contact tool="bar" friction="0.1"/>
  <ThreadLoad at="150 mm" force="-0.05 0 0 N"/>
  <Track name="way" times="0 0.05 0.2 s" positions="0 0 0  -0.4 0 -7.5  -0.4 0 -97.5 mm"/>
  <Grasper name="hand" track="way" at="0 mm" rotation_stiffness="0"/>)";

// However far it goes in a step, up to 12 mm: every step is solved, nothing comes into the bar by
// more than the twentieth of the thickness that touches between nodes may leave, the hand pulls
// with the load times exp(mu pi / 2) (beams of 0.5 mm on an arc of 0.8 mm: to 5 %), and the thread
// has come as far (to 5 um, as touches may miss by the tolerance of gaps, 1 um, each).
TEST(Corner, IsGoneRoundAtAnyStep) {
  const Real pull = load * std::exp(mu * std::numbers::pi / 2);
  Real place = 0;
  for (const char* dt : {"5 ms", "10 ms", "20 ms"}) {
    TextRun run(scene, std::string("gravity='0 0 0' dt='") + dt + "'");
    ASSERT_TRUE(run) << run.said();
    Index passes = 0, steps = 0;
    while (run.simulation().time() < 0.12 - 1e-9) {
      const StepReport& report = run.simulation().step();
      EXPECT_FALSE(report.missed()) << dt << ' ' << report.time;
      EXPECT_GT(run.number("/contact", "distance"), -0.2e-3 / 20) << dt << ' ' << report.time;
      passes += report.passes, ++steps;
    }
    EXPECT_NEAR(-run.vector("/hand", "force").z(), pull, 0.05 * pull) << dt;
    const Real end = run.vector("/suture", "end_position").x();
    if (place == 0) place = end;
    EXPECT_NEAR(end, place, 5e-6) << dt;
    // With ways that are straight from the start of the step 121, 232, 372 passes a step, and most
    // steps of 20 ms were missed.
    EXPECT_LT(passes, 150 * steps) << dt;
  }
}

}  // namespace
}  // namespace sutura::testing
