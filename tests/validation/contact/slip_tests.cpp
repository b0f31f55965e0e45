// Two throws upon each other (scenes/knots/slip.xml): the hand of the second makes a square knot or
// a granny, and the granny slips where the square knot holds.
#include <gtest/gtest.h>

#include "scenes/text_run.h"
#include "support/closed_line.h"
#include "support/knot_type.h"

namespace sutura::testing {
namespace {

struct Pulled {
  Complex laid_out = 0, pulled = 0;
  Real tight = 0, held = 0;  ///< of the legs, when the ends are let go, and at the end (N)
  Real slip = 0;             ///< of both loose ends since then, on average (m)
  int steps = 0, missed = 0;
};

Pulled pull(const std::string& start, Real seconds) {
  TextRun world = TextRun::file("knots/slip.xml", {{"/suture.thread_start_file", start}});
  const auto& thread = world.component<SegmentedCurve>("/suture");
  const auto knot = [&] { return jones(closed_to_the_sides(thread, 4)); };
  const auto ends = [&] {
    return world.vector("/suture", "end_position").x() -
           world.vector("/suture", "tip_position").x();
  };
  const auto legs = [&] { return world.vector("/left", "force").norm(); };
  Pulled out;
  out.laid_out = knot();
  const auto run = [&](Real until) {
    while (world.simulation().time() < until - 1e-9) {
      ++out.steps;
      out.missed += !world.simulation().step().solved;
    }
  };
  run(0.8);
  out.tight = legs();
  const Real before = ends();
  run(seconds);
  out.held = legs();
  out.slip = (before - ends()) / 2;
  out.pulled = knot();
  return out;
}

// Strands of a knot roll as it is drawn together, and a tolerance that is blind to roll leaves a
// friction in every step, all of it with one sign (15 % of the force on an earlier code). The knot
// is laid out far from balance, and the first step finds one of several states that it springs to:
// the legs remember it, by 7 mN. What they feel more from 0.1 to 0.5 s does not depend on
// that: 75.2 to 75.6 mN at 2.5 to 10 ms, with either tolerance. Blind to roll these two differ
// by 1.3 %.
TEST(Slip, WhileItIsTightenedItPullsAsWithATenthOfTheTolerance) {
  const auto legs = [](const std::string& tolerance) {
    TextRun world = TextRun::file("knots/slip.xml", {{".tolerance", tolerance}});
    world.run(0.1);
    const Real before = world.vector("/left", "force").norm();
    world.run(0.5);
    return world.vector("/left", "force").norm() - before;
  };
  const Real fine = legs("0.001");
  EXPECT_NEAR(legs("0.01"), fine, 0.01 * fine);
}

TEST(Slip, AGrannySlipsWhereASquareKnotHolds) {
  const Pulled square = pull("square_start.csv", 1), granny = pull("granny_start.csv", 1);
  for (const Pulled* p : {&square, &granny})
    std::printf("legs %g to %g N, ends in by %g mm, %d of %d steps missed\n", p->tight, p->held,
                1e3 * p->slip, p->missed, p->steps);
  constexpr Real rounding = 1e-6;
  const Complex one = jones_of_throw(3);
  EXPECT_LT(std::abs(square.laid_out - std::norm(one)), rounding);
  EXPECT_LT(std::abs(granny.laid_out - one * one), rounding);
  EXPECT_LT(std::abs(square.pulled - square.laid_out), rounding);
  EXPECT_LT(std::abs(granny.pulled - granny.laid_out), rounding);
  // The hands give way by 10 mm per newton and have gone 1 mm on.
  EXPECT_NEAR(square.held - square.tight, 0.1, 0.02);
  EXPECT_LT(std::abs(square.slip), 0.1e-3);
  EXPECT_GT(granny.slip, 0.3e-3);
  EXPECT_LT(granny.held, 0.8 * square.held);
}

}  // namespace
}  // namespace sutura::testing
