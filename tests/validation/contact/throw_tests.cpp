// A throw is tied with instruments (scenes/knots/throw.xml), judged by the kind of knot that the
// thread makes, after every step, and by what goes through what, not by the code that prevents it.
#include <gtest/gtest.h>

#include "scenes/text_run.h"
#include "support/closed_line.h"
#include "support/knot_type.h"

namespace sutura::testing {
namespace {

constexpr KnotInvariant no_knot{1, 1};

// A (2, n) torus knot on a torus about z. With growing angle it turns left-handed or right-handed.
Line torus_knot(int n, int hand, const Vec3& middle) {
  Line line;
  for (int i = 0; i < 40 * n; ++i) {
    const Real a = 4 * std::numbers::pi * i / (40 * n), b = hand * n * a / 2;
    const Real r = 2 + std::cos(b);
    line.push_back(middle + Vec3(r * std::cos(a), r * std::sin(a), -std::sin(b)));
  }
  return line;
}

// Two knots one after another: both opened at their rightmost and leftmost point.
Line one_after_another(const Line& a, const Line& b) {
  const auto by_x = [](const Vec3& p, const Vec3& q) { return p.x() < q.x(); };
  Line first = a, second = b;
  std::rotate(first.begin(), std::max_element(first.begin(), first.end(), by_x), first.end());
  std::rotate(second.begin(), std::min_element(second.begin(), second.end(), by_x), second.end());
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

TEST(KnotType, TellsAKnotFromItsImageAndASquareKnotFromAGranny) {
  constexpr Real rounding = 1e-9;
  const Vec3 far(10, 0, 0);
  for (const int n : {3, 5, 7}) {
    const Complex right = jones(torus_knot(n, 1, Vec3::Zero()));
    EXPECT_LT(std::abs(right - jones_of_throw(n)), rounding) << n;
    EXPECT_LT(std::abs(jones(torus_knot(n, -1, Vec3::Zero())) - std::conj(right)), rounding) << n;
  }
  const Complex one = jones_of_throw(3);
  const Line a = torus_knot(3, 1, Vec3::Zero()), same = torus_knot(3, 1, far),
             other = torus_knot(3, -1, far);
  EXPECT_LT(std::abs(jones(one_after_another(a, same)) - one * one), rounding);
  EXPECT_LT(std::abs(jones(one_after_another(a, other)) - std::norm(one)), rounding);
  EXPECT_LT(std::abs(jones({Vec3::Zero(), Vec3::UnitX(), Vec3(0.3, 1, 0.2)}) - 1.), rounding);
}

struct Tied {
  int steps = 0, missed = 0, crossings = 0;
  Real became = 0;          ///< when it became a knot (s)
  int changes = 0;          ///< of the kind of knot
  Real distance = 0;        ///< the smallest (m)
  Complex knot = 0;         ///< at the end
  Real hand = 0, tail = 0;  ///< tension of the two strands at the end (N)
};

Tied tie(std::vector<std::pair<std::string, std::string>> overrides, Real seconds) {
  TextRun world = TextRun::file("knots/throw.xml", std::move(overrides));
  Tied out;
  const auto& thread = world.component<SegmentedCurve>("/suture");
  KnotInvariant kind = knot_invariant(closed_to_the_sides(thread, 2));
  EXPECT_EQ(kind, no_knot) << "as laid out";
  Line before = line_of(thread);
  while (world.simulation().time() < seconds - 1e-9) {
    const StepReport& report = world.simulation().step();
    EXPECT_TRUE(report.finite);
    EXPECT_TRUE(report.faults.empty()) << report.faults.front();
    ++out.steps;
    out.missed += !report.solved;
    out.distance = std::min(out.distance, world.number("/knot", "distance"));
    const Line now = line_of(thread);
    // The judge takes the way of a step for straight, which that of a divided one is not; the kind
    // of knot is looked at after those too.
    if (report.parts == 1) out.crossings += crossings(before, now, before, now, true);
    before = now;
    const KnotInvariant next = knot_invariant(closed_to_the_sides(thread, 2));
    if (!(next == kind)) ++out.changes, out.became = report.time;
    kind = next;
  }
  out.knot = jones(closed_to_the_sides(thread, 2));
  out.hand = world.vector("/hand", "force").norm();
  out.tail = world.vector("/tips", "force").norm();
  return out;
}

TEST(InstrumentTie, TiesOneThrow) {
  const Tied tied = tie({}, 5.2);
  std::printf("%d of %d steps missed their tolerance; hand %g N, tail %g N\n", tied.missed,
              tied.steps, tied.hand, tied.tail);
  EXPECT_EQ(tied.crossings, 0);
  // The end of the tail goes through the loop, once.
  EXPECT_EQ(tied.changes, 1);
  constexpr Real rounding = 1e-6;
  // Wound over the top towards the hand's own side, a throw is right-handed.
  EXPECT_LT(std::abs(tied.knot - jones_of_throw(3)), rounding);
  // When the thread is let go, and when the throw jerks tight; a step more on another machine.
  EXPECT_LE(tied.missed, tied.steps / 200);
  EXPECT_GT(tied.distance, -0.01e-3);  // a twentieth of the thickness (docs/theory/contact.md)
  // The hand gives way by 20 mm per newton and is drawn 10 mm too far.
  EXPECT_NEAR(tied.hand, 0.5, 0.1);  // less what the throw takes of the strand
  EXPECT_GT(tied.tail, 0.05);
}

TEST(InstrumentTie, TiesASquareKnotThatHoldsWhenItsEndsAreCut) {
  TextRun world = TextRun::file("knots/square.xml");
  const auto& thread = world.component<SegmentedCurve>("/suture");
  int steps = 0, missed = 0;
  const auto run = [&](Real until) {
    while (world.simulation().time() < until - 1e-9) {
      ++steps;
      missed += !world.simulation().step().solved;
    }
  };
  constexpr Real rounding = 1e-6;
  const Complex one = jones_of_throw(3);
  run(5.2);
  EXPECT_LT(std::abs(jones(closed_to_the_sides(thread, 2)) - one), rounding);
  run(10.6);
  // The ends have changed sides. A granny would be the square of one throw.
  EXPECT_LT(std::abs(jones(closed_to_the_sides(thread, 2, -1)) - std::norm(one)), rounding);
  // The hand gives way by 20 mm per newton and is drawn 2 mm too far.
  EXPECT_NEAR(world.vector("/hand", "force").norm(), 0.05, 0.03);
  // Both ends are cut at 10.7 s, and shake the knot while they swing. Then what is left is at rest,
  // and still a square knot.
  run(12);
  EXPECT_EQ(world.number("/suture", "cuts"), 2);
  const Line before = after_cuts(thread, 1);
  run(12.5);
  const Line after = after_cuts(thread, 1);
  ASSERT_EQ(before.size(), after.size());
  Real moved = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    moved = std::max(moved, (after[i] - before[i]).norm());
  std::printf("%d of %d steps missed their tolerance; moved by %g um in 0.5 s\n", missed, steps,
              1e6 * moved);
  EXPECT_LT(std::abs(jones(closed_to_the_sides(after, -1)) - std::norm(one)), rounding);
  EXPECT_LE(missed, steps / 200);  // as for one throw
  // What sticks may move by the tolerance of a step, 1 um, and takes that back in the next.
  EXPECT_LT(moved, 5e-6);
}

}  // namespace
}  // namespace sutura::testing
