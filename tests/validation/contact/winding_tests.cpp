// A thread is laid on a bar, three turns, and taken off again: scenes/contact/three_turns.xml.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenes/text_run.h"
#include "stability/contact/crossings.h"

namespace sutura::testing {
namespace {

/// Turns of the line round the z axis.
Real turns(const Line& line) {
  Real sum = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vec3 &p = line[i], &q = line[i + 1];
    sum += std::atan2(p.x() * q.y() - p.y() * q.x(), p.x() * q.x() + p.y() * q.y());
  }
  return sum / (2 * std::numbers::pi);
}

TEST(Winding, ThreeTurnsAreLaidOnABarAndTakenOff) {
  TextRun run = TextRun::file("contact/three_turns.xml");
  ASSERT_TRUE(run) << run.said();
  const auto& thread = run.component<SegmentedCurve>("/suture");
  run.run(0.3);
  const Line start = line_of(thread, 1);  // taut, beside the bar
  const Line axis{Vec3(0, 0, -0.1), Vec3(0, 0, 0.1)};
  constexpr Real bar = 3e-3, r = 0.1e-3;  // m, radii
  Line before = line_of(thread, 4);
  Real most = 0, touches = 0;
  while (run.simulation().time() < 4 - 1e-9) {  // the scene ends at 3.6 s, as it comes off
    const StepReport& report = run.simulation().step();
    EXPECT_TRUE(report.solved) << report.time;
    const Line now = line_of(thread, 4);
    for (const Vec3& p : now) EXPECT_GT(std::hypot(p.x(), p.y()), bar + 0.9 * r) << report.time;
    EXPECT_EQ(crossings(before, now, axis, axis, false), 0) << report.time;
    before = now;
    most = std::max(most, turns(now));
    touches = std::max(touches, run.number("/on_bar", "touches"));
  }
  // A straight thread that is touched at one place sees the bar under half a turn, less where its
  // ends are near: atan(30 / 3.1) and atan(90 / 3.1) are 0.24 of a turn each.
  EXPECT_NEAR(most, 3 + turns(start), 0.03);
  EXPECT_GT(touches, 50);
  // Off again, as it was before.
  const Line end = line_of(thread, 1);
  EXPECT_NEAR(turns(end), turns(start), 1e-3);
  for (std::size_t i = 0; i < end.size(); ++i) EXPECT_LT((end[i] - start[i]).norm(), 1e-6) << i;
}

}  // namespace
}  // namespace sutura::testing
