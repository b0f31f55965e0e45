// What holds for every pair: forces cancel, results do not depend on where a scene stands, and a
// state goes on to the bit.
#include <gtest/gtest.h>

#include "contact_scenes.h"
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

/// A thread flies across another; both are free.
std::string collision() {
  return "<plugin name='contact'/>"
         "<SutureThread name='a' needle_length='0' thread_diameter='0.2 mm' thread_length='20 mm' "
         "thread_beams='20' tip='0 -6 1 mm' tip_direction='0 -1 0' velocity='0.1 0 -0.4'/>"
         "<SutureThread name='b' needle_length='0' thread_diameter='0.2 mm' thread_length='20 mm' "
         "thread_beams='20' tip='-10 0 0 mm' tip_direction='-1 0 0'/>"
         "<Contact first='a' second='b' friction='0.3'/>";
}

TEST(Pair, WhatOneLosesTheOtherGains) {
  TextRun run(collision(), "dt='1 ms' gravity='0 0 0' tolerance='1e-5'");
  ASSERT_TRUE(run) << run.said();
  const auto momentum = [&] {
    return Vec3(run.vector("/a", "momentum") + run.vector("/b", "momentum"));
  };
  const Vec3 before = momentum();
  Real passed_on = 0;
  for (int i = 0; i < 20; ++i) {
    const StepReport& report = run.simulation().step();
    EXPECT_TRUE(report.solved) << i << " " << report.worst_imbalance().relative << " "
                               << (momentum() - before).norm() / before.norm();
    // A step may leave 1e-5 of the forces at work unbalanced.
    EXPECT_LT((momentum() - before).norm(), 1e-4 * before.norm()) << i;
    passed_on = std::max(passed_on, run.vector("/b", "momentum").norm());
  }
  EXPECT_GT(passed_on, 0.1 * before.norm());
}

TEST(Pair, AStateGoesOnToTheBit) {
  const std::string settings = "dt='1 ms' gravity='0 0 0'";
  TextRun whole(collision(), settings), other(collision(), settings);
  ASSERT_TRUE(whole) << whole.said();
  while (whole.number("/contact", "touches") < 1 && whole.simulation().time() < 0.02)
    whole.simulation().step();
  ASSERT_GT(whole.number("/contact", "touches"), 0);
  const std::vector<std::byte> state = whole.simulation().save();
  ASSERT_EQ(other.simulation().restore(state), "");
  for (int i = 0; i < 10; ++i) {
    whole.simulation().step();
    other.simulation().step();
    ASSERT_EQ(whole.vector("/a", "tip_position"), other.vector("/a", "tip_position")) << i;
    ASSERT_EQ(whole.vector("/contact", "force"), other.vector("/contact", "force")) << i;
  }
}

/// Force and moment about the origin of all constraints on all bodies together, and how much one
/// body gets of them.
struct Sum {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  Real of_one = 0;
};

Sum sum_of_forces(TextRun& run) {
  Sum sum;
  const ConstraintProblem& problem = run.simulation().problem();
  const auto& bodies = run.simulation().bodies();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    VecX force = VecX::Zero(bodies[b].body->dofs());
    problem.bodies[b].add_transposed(problem.lambda, force);
    const std::vector<Vec3> points = bodies[b].body->geometry().points;
    const int width = bodies[b].body->width();
    EXPECT_EQ(static_cast<Index>(points.size()) * width, force.size());
    Vec3 here = Vec3::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Index at = static_cast<Index>(i) * width;
      here += force.segment<3>(at);
      sum.moment += points[i].cross(force.segment<3>(at));
      if (width == 6) sum.moment += force.segment<3>(at + 3);
    }
    sum.force += here;
    sum.of_one = std::max(sum.of_one, here.norm());
  }
  return sum;
}

/// What one gets of force and of turning the other loses: whatever is left of the step's tolerance.
/// Arms are up to 30 mm.
void expect_that_forces_cancel(const std::string& scene, const std::string& gravity) {
  TextRun run("<plugin name='contact'/>" + scene, "dt='2 ms' gravity='" + gravity + "'");
  ASSERT_TRUE(run) << run.said();
  int touched = 0;
  for (int i = 0; i < 60; ++i) {
    run.simulation().step();
    const Sum sum = sum_of_forces(run);
    if (!(sum.of_one > 0)) continue;
    ++touched;
    EXPECT_LT(sum.force.norm(), 1e-12 * sum.of_one) << i;
    // To the gap at which the two points of a touch are apart, a micrometre.
    EXPECT_LT(sum.moment.norm(), (1e-12 * 30e-3 + 1e-6) * sum.of_one) << i;
  }
  EXPECT_GT(touched, 2);
}

TEST(Pair, ForcesCancelBetweenThreads) {
  expect_that_forces_cancel(
      thread("a", Vec3(1e-3, 2e-3, 0.4e-3), Vec3(0.6, 0.8, 0), 0.02, 20, "velocity='0 0 -0.2'") +
          thread("b", Vec3::Zero(), Vec3::UnitX(), 0.03, 30) +
          "<Contact first='a' second='b' friction='0.3'/>",
      "0 0 0");
}

TEST(Pair, ForcesCancelBetweenThreadAndTissue) {
  expect_that_forces_cancel(
      thread("a", Vec3(1e-3, 2e-3, 0.4e-3), Vec3(0.6, 0.8, 0), 0.02, 20, "velocity='0 0 -0.2'") +
          block("skin", "-10 -10 -8 10 10 0", "5 5 3", "<Attach box='-10 -10 -8 10 10 -8 mm'/>") +
          "<Contact first='a' second='/skin/tissue' friction='0.3'/>",
      "0 0 -9.81");
}

TEST(Pair, ForcesCancelBetweenTissues) {
  expect_that_forces_cancel(
      block("high", "-3 -4 0.2 5 3 8", "3 3 3") +
          block("low", "-10 -10 -8 10 10 0", "5 5 3", "<Attach box='-10 -10 -8 10 10 -8 mm'/>") +
          "<Contact first='/high/tissue' second='/low/tissue' friction='0.3'/>",
      "0 0 -9.81");
}

/// A thread falls on a bar and on another thread, all of it turned and shifted.
Vec3 end_of_fall(const Mat3& turn, const Vec3& shift) {
  const auto at = [&](const Vec3& x) { return Vec3(turn * x + shift); };
  const auto laid = [&](const std::string& name, const Vec3& middle, const Vec3& along,
                        const std::string& more) {
    return thread(
        name, at(middle), turn * along, 0.03, 30,
        "damping_mass='5 1/s' plane_normal='" + text_of(turn * Vec3::UnitZ()) + "' " + more);
  };
  const std::string scene =
      laid("a", Vec3(2e-3, 0, 4.2e-3), Vec3::UnitX(), "") +
      laid("b", Vec3(0, 3e-3, 3.5e-3), Vec3(0.6, 0.8, 0), "clamp='both'") +
      "<Tool name='bar' shape='cylinder' radius='3 mm' length='30 mm' centre='" +
      text_of(at(Vec3::Zero())) + "' axis='" + text_of(turn * Vec3::UnitY()) +
      "'/><Contact name='on_bar' first='a' tool='bar' friction='0.3'/>"
      "<Contact name='on_thread' first='a' second='b' friction='0.3'/>";
  TextRun run("<plugin name='contact'/>" + scene,
              "dt='5 ms' tolerance='1e-5' gap_tolerance='1e-9 m' passes='40' gravity='" +
                  text_of(turn * Vec3(0, 0, -9.81)) + "'");
  EXPECT_TRUE(run) << run.said();
  if (!run) return Vec3::Zero();
  Real touches = 0;
  while (run.simulation().time() < 0.1 - 1e-9) {
    EXPECT_TRUE(run.simulation().step().solved) << run.simulation().time();
    touches += run.number("/on_bar", "touches") + run.number("/on_thread", "touches");
  }
  EXPECT_GT(touches, 5);
  return turn.transpose() * (run.vector("/a", "tip_position") - shift);
}

// Steps are solved to a hundred-thousandth of the forces; a tenth of a second of fall is 50 mm.
TEST(Pair, IsTheSameFromEverySide) {
  const Vec3 as_is = end_of_fall(Mat3::Identity(), Vec3::Zero());
  const Mat3 turn = Eigen::AngleAxis<Real>(2, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  EXPECT_LT((end_of_fall(turn, Vec3::Zero()) - as_is).norm(), 1e-6);
  EXPECT_LT((end_of_fall(Mat3::Identity(), Vec3(0.03, -0.05, 0.02)) - as_is).norm(), 1e-6);
}

}  // namespace
}  // namespace sutura::testing
