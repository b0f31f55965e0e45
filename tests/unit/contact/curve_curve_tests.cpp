// Touches of two straight threads of 0.2 mm, one along x and one across it, against plane geometry.
#include <gtest/gtest.h>

#include <numbers>

#include "contact_memory.h"
#include "curve_curve.h"
#include "scenes/text_run.h"

namespace sutura::contact {
namespace {

using testing::TextRun;

constexpr Real diameter = 0.2e-3;

/// The second lies `height` below the first and at `degrees` to it.
TextRun crossed(Real height, Real degrees) {
  const Real angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
  const auto thread = [](const std::string& name, Real x, Real y, Real z) {
    const auto text = [](Real a, Real b, Real d) {
      return std::to_string(a) + ' ' + std::to_string(b) + ' ' + std::to_string(d);
    };
    return "<SutureThread name='" + name +
           "' needle_length='0' thread_diameter='0.2 mm' thread_length='20 mm' thread_beams='20' "
           "tip='" +
           text(10 * x, 10 * y, z) + " mm' tip_direction='" + text(x, y, 0) + "' plane_normal='" +
           text(-y, x, 0) + "'/>";
  };
  return TextRun(thread("a", 1, 0, 0) + thread("b", c, s, -1e3 * height));
}

struct Crossed {
  Crossed(Real height, Real degrees)
      : run(crossed(height, degrees)),
        pair(run.component<SegmentedCurve>("/a"), run.component<SegmentedCurve>("/b")) {
    memory.begin_step();
    pair.find(memory, touches);
  }
  TextRun run;
  CurveCurve pair;
  ContactMemory memory;
  std::vector<Touch> touches;
};

// Whatever the angle: touches at nodes below 30 degrees, one where they cross above.
TEST(CurveCurve, FindsATouchAgainAtItsPlace) {
  constexpr Real height = 0.19e-3, place = 10.03e-3, aside = 0.03e-3;
  for (const Real degrees : {25., 29., 31., 65.}) {
    const Crossed threads(height, degrees);
    Touch touch;
    ASSERT_TRUE(threads.pair.find_again(place, place, touch)) << degrees;
    EXPECT_NEAR(touch.first_place, place, 1e-9);
    const Real across = aside * std::sin(degrees * std::numbers::pi / 180);
    EXPECT_NEAR(touch.gap, std::hypot(height, across) - diameter, 1e-9) << degrees;
    // Half a thickness away there is none.
    EXPECT_FALSE(threads.pair.find_again(10.7e-3, 10.7e-3, touch)) << degrees;
  }
}

// Threads that begin 0.05 mm deep in each other: a step takes a twentieth of the thickness back and
// leaves the rest.
TEST(CurveCurve, TakesADeepOverlapBackInSteps) {
  for (const Real degrees : {30., 90.}) {
    const Crossed threads(0.15e-3, degrees);
    ASSERT_FALSE(threads.touches.empty());
    Real deepest = 0;
    for (const Touch& t : threads.touches) {
      deepest = std::min(deepest, t.gap);
      if (t.gap < -diameter / 20) {
        EXPECT_NEAR(t.gap + t.left, t.gap + 0.04e-3, 1e-9);
      }
    }
    EXPECT_NEAR(deepest, -0.05e-3, 1e-9);
  }
  // What overlaps by less is taken back at once.
  for (const Touch& t : Crossed(0.192e-3, 90).touches) EXPECT_EQ(t.left, 0);
}

// A thread that folds at a hand is nearer to itself than two strands may come, as it begins to
// count as two. It is not held for ever where it is: it may go wherever it comes no nearer by a
// tenth.
TEST(CurveCurve, WhatBeginsTooNearMayGoApart) {
  Crossed threads(0.09e-3, 90);  // half a thickness is as near as they may come
  Body& body = threads.run.component<Body>("/a");
  body.load().setZero(body.dofs());
  body.begin_step(StepContext{});
  const auto free_way = [&](const Vec3& by) {  // of the first thread as a whole (m)
    VecX motion = VecX::Zero(body.dofs());
    for (Index i = 0; i < body.dofs(); i += 6) motion.segment<3>(i) = by;
    body.move_to(StepContext{}, motion);
    threads.touches.clear();
    threads.pair.find(threads.memory, threads.touches);
    return threads.pair.free_way();
  };
  EXPECT_EQ(free_way({0, 0, 0.05e-3}), 1);
  EXPECT_EQ(free_way({0, 0.3e-3, 0}), 1);
  EXPECT_EQ(free_way({0, 0, -0.008e-3}), 1);
  // Through the other one, 0.09 mm below, a tenth of that is free.
  EXPECT_NEAR(free_way({0, 0, -0.18e-3}), 0.009 / 0.18, 1e-3);
}

// A third of a circle that hands turn in its plane within a step: on the straight way from one
// state to the other it shrinks, and from some 150 degrees on it goes through itself.
TEST(CurveCurve, SeesAStrandGoThroughItselfAsItIsTurnedRound) {
  for (const Real turn : {0.5, 1.5, 2.9}) {
    TextRun run(
        "<SutureThread name='a' needle_length='20 mm' needle_angle='120 deg' needle_diameter='0.5 "
        "mm' thread_length='5 mm' thread_beams='2' tip='0 0 0' tip_direction='-1 0 0'/>"
        "<Track name='way' times='0 10 ms' rotations='0 0 0 0 0 " +
            std::to_string(turn) + "'/><Grasper track='way' at='10 mm'/>",
        "dt='10 ms' gravity='0 0 0' substeps='1'");
    ASSERT_TRUE(run) << run.said();
    run.simulation().step();
    const auto& curve = run.component<SegmentedCurve>("/a");
    const Vec3 was = curve.tangent(10e-3, Configuration::start),
               is = curve.tangent(10e-3, Configuration::current);
    ASSERT_NEAR(std::acos(was.dot(is)), turn, 0.1);
    CurveCurve pair(curve, curve);
    ContactMemory memory;
    memory.begin_step();
    std::vector<Touch> touches;
    pair.find(memory, touches);
    if (turn < 2)
      EXPECT_EQ(pair.free_way(), 1) << turn;
    else
      EXPECT_LT(pair.free_way(), 1) << turn;
    EXPECT_TRUE(touches.empty());
  }
}

}  // namespace
}  // namespace sutura::contact
