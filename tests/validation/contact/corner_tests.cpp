// A thread that is drawn round a corner by much more than the corner in a step:
// scenes/contact/corner.xml.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

// However far it goes in a step: every step is solved, nothing comes into the bar by more than the
// twentieth of the thickness that touches between nodes may leave, the hand pulls with 50 mN times
// exp(mu pi / 2) (beams of 0.5 mm on an arc of 0.8 mm: to 5 %), and the thread has come as far.
TEST(Corner, IsGoneRoundAtAnyStep) {
  constexpr Real load = 0.05, mu = 0.1;
  const Real pull = load * std::exp(mu * std::numbers::pi / 2);
  Real place = 0;
  for (const char* dt : {"5 ms", "10 ms", "20 ms"}) {
    TextRun run = TextRun::file("contact/corner.xml", {{".dt", dt}});
    ASSERT_TRUE(run) << run.said();
    Index passes = 0, steps = 0;
    while (run.simulation().time() < 0.2 - 1e-9) {
      const StepReport& report = run.simulation().step();
      EXPECT_FALSE(report.missed()) << dt << ' ' << report.time;
      EXPECT_GT(run.number("/contact", "distance"), -0.2e-3 / 20) << dt << ' ' << report.time;
      passes += report.passes, ++steps;
    }
    EXPECT_NEAR(-run.vector("/hand", "force").z(), pull, 0.05 * pull) << dt;
    const Real end = run.vector("/suture", "end_position").x();
    if (place == 0) place = end;
    EXPECT_NEAR(end, place, 5e-6) << dt;
    // Straight ways alone took 121, 232, 372 passes a step, in up to 16 parts, and missed 8 of
    // 10 steps of 20 ms.
    EXPECT_LT(passes, 150 * steps) << dt;
  }
}

}  // namespace
}  // namespace sutura::testing
