// Twist is put into a thread that is held at both ends until it winds about itself, and taken out
// again: scenes/knots/plectoneme.xml.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenes/text_run.h"
#include "stability/contact/crossings.h"

namespace sutura::testing {
namespace {

// Of the scene (s): slack and not turned yet, turned and held, back again.
constexpr Real laid = 0.6, turned = 3.1, held_until = 3.7, end = 8;
constexpr int parts = 4;  // a beam turns by less than a radian: within a twentieth of its thickness

/// The moment at which two strands of a thread stay wound about each other under the tension T.
/// Each is a helix on a cylinder of the thread's radius, at an angle a to the axis of both
/// (Clauvelin, Audoly, Neukirch, Macromolecules 41, 2008):
///   T = EI / r^2 sin^4 a (1/2 + 1 / cos 2a),    M = 2 EI / r sin^3 a cos a / cos 2a.
Real moment_at(Real tension) {
  constexpr Real r = 0.1e-3, young = 1.5e9, EI = young * std::numbers::pi * r * r * r * r / 4;
  Real low = 0, high = 0.7;
  while (high - low > 1e-12) {
    const Real a = (low + high) / 2, s = std::sin(a);
    const Real T = EI / (r * r) * s * s * s * s * (0.5 + 1 / std::cos(2 * a));
    (T < tension ? low : high) = a;
  }
  const Real s = std::sin(low);
  return 2 * EI / r * s * s * s * std::cos(low) / std::cos(2 * low);
}

/// Runs on to `until` and counts how often the thread has gone through itself.
int crossings_until(Real until, TextRun& run) {
  const auto& thread = run.component<SegmentedCurve>("/suture");
  Line before = line_of(thread, parts);
  int count = 0;
  while (run.simulation().time() < until - 1e-9) {
    const StepReport& report = run.simulation().step();
    EXPECT_TRUE(report.solved) << report.time;
    const Line now = line_of(thread, parts);
    count += crossings(before, now, before, now, true, parts);
    before = now;
  }
  return count;
}

TEST(Plectoneme, WindsUpAndComesBack) {
  TextRun run = TextRun::file("knots/plectoneme.xml", {{"/itself.friction", "0"}});
  ASSERT_TRUE(run) << run.said();
  const auto& thread = run.component<SegmentedCurve>("/suture");
  EXPECT_EQ(crossings_until(laid, run), 0);
  const Line slack = line_of(thread, 1);
  EXPECT_EQ(crossings_until(turned, run), 0);

  // Held, without friction: a balance of tension and moment. Two and a half windings only, and what
  // touches at nodes goes from one to the next: the tension swings by a fifth.
  Real tension = 0, moment = 0;
  int steps = 0;
  while (run.simulation().time() < held_until - 1e-9) {
    EXPECT_TRUE(run.simulation().step().solved);
    tension += run.vector("/hand", "force").x();
    moment += run.vector("/hand", "moment").x();
    ++steps;
  }
  EXPECT_GT(run.number("/itself", "touches"), 12);
  RecordProperty("moment_against_theory",
                 std::to_string(moment / steps / moment_at(tension / steps)));
  EXPECT_NEAR(moment / steps, moment_at(tension / steps), 0.15 * moment_at(tension / steps));

  EXPECT_EQ(crossings_until(end, run), 0);
  EXPECT_EQ(run.number("/itself", "touches"), 0);
  // It has swung out, also from where it may have stood on end.
  const Line back = line_of(thread, 1);
  for (std::size_t i = 0; i < back.size(); ++i) EXPECT_LT((back[i] - slack[i]).norm(), 1e-6) << i;
}

}  // namespace
}  // namespace sutura::testing
