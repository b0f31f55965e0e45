// One implicit Euler step of a rod: what balances at its end, and how it gets there.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "divided_step.h"
#include "rod_builder.h"
#include "rod_potential.h"
#include "rod_static.h"

namespace sutura::thread {
namespace {

const Vec3 gravity(0, 0, -9.81);

/// Forces of the axial stiffness are rounded to 1e-14 of it; where little else is at work that is
/// 1e-6 of what is.
constexpr Real balanced = 1e-5;

/// Free and straight, thrown in waves of about `speed` (m/s) that bend, turn and spin its sections.
Rod thrown(Real speed) {
  const RodLayout layout = straight_layout(0.2, 40, nylon());
  Rod rod;
  rod.build(layout);
  for (Index i = 0; i < rod.nodes(); ++i) {
    const Real x = rod.abscissa()[i];
    rod.velocity().segment<3>(6 * i) = speed * Vec3(0.3, std::sin(20 * x), 0.5 + std::cos(15 * x));
    rod.velocity().segment<3>(6 * i + 3) =
        speed * Vec3(20, 15 * std::sin(15 * x), 20 * std::cos(20 * x));
  }
  return rod;
}

TEST(RodStep, AThrownRodBalancesAndKeepsItsMomentumAtAnyStep) {
  for (const Real dt : {1e-4, 1e-3, 5e-3, 10e-3, 20e-3, 50e-3}) {
    Rod rod = thrown(0.1);
    RodStep step(rod);
    const VecX none = VecX::Zero(rod.dofs());
    for (int i = 0; i < 20; ++i) {
      const Vec3 before = rod.momentum();
      ASSERT_TRUE(divided_step(rod, step, dt, gravity, balanced)) << dt << ' ' << i;
      EXPECT_LE(step.imbalance(rod, none).relative, balanced);
      // Inner forces cancel in the sum, so what can be missing is rounding and the imbalance of
      // the nodes that the step leaves.
      const Real left = dt * step.imbalance(rod, none).force * static_cast<Real>(rod.nodes());
      EXPECT_LE((rod.momentum() - before - dt * rod.mass() * gravity).norm(),
                left + 1e-12 * (before.norm() + dt * rod.mass() * gravity.norm()))
          << dt << ' ' << i;
    }
  }
}

TEST(RodStep, DampingAgainstAStandingWorldTakesItsShareOfMomentum) {
  // M (v - v_start) = -h alpha M v for the whole rod.
  Rod rod = thrown(0.1);
  RodStep step(rod);
  step.damping = {.mass = 7, .stiffness = 1e-3};
  const Vec3 before = rod.momentum();
  ASSERT_GT(step.advance(rod, 0.01, Vec3::Zero(), VecX::Zero(rod.dofs()), balanced), 0);
  const Real left = 0.01 * step.imbalance(rod, VecX::Zero(rod.dofs())).force * 41;
  EXPECT_LE((rod.momentum() - before / (1 + 0.01 * 7)).norm(), left + 1e-12 * before.norm());
}

// The matrix is the derivative of the balance except for the turning of the tangents: each pass
// gains digits, and a few are enough for all of them.
TEST(RodStep, PassesConvergeFast) {
  for (const Real dt : {1e-3, 10e-3}) {
    Rod rod = thrown(0.1);
    RodStep step(rod);
    const VecX none = VecX::Zero(rod.dofs());
    for (int i = 0; i < 50; ++i) {
      const Index passes = step.advance(rod, dt, gravity, none, balanced);
      ASSERT_GT(passes, 0) << dt << ' ' << i;
      EXPECT_LE(passes, 12) << dt << ' ' << i;
    }
  }
}

TEST(RodStep, ImbalanceIsTheForceThatIsMissing) {
  Rod rod;
  rod.build(straight_layout(0.1, 20, nylon()));
  RodStep step(rod);
  step.begin(rod, 0.01, Vec3::Zero());
  VecX force = VecX::Zero(rod.dofs());
  EXPECT_EQ(step.imbalance(rod, force).force, 0);
  EXPECT_EQ(step.imbalance(rod, force).relative, 0);
  force.segment<3>(6 * 7) = Vec3(0, 3e-6, 4e-6);
  EXPECT_NEAR(step.imbalance(rod, force).force, 5e-6, 1e-15);
  // Nothing else is at work there but what counts as rounding of the strain: 1e-10 EA a beam.
  const Real rounding = 2e-10 * nylon().young * nylon().area();
  EXPECT_NEAR(step.imbalance(rod, force).relative, 5e-6 / (5e-6 + rounding), 1e-5);
  // The answer takes it away.
  for (int pass = 0; pass < 10; ++pass) {
    ASSERT_TRUE(step.linearise(rod, force));
    step.correct(rod);
  }
  EXPECT_LT(step.imbalance(rod, force).relative, balanced);
  step.end(rod, force);
}

/// Largest distance of a node (m) between two rods of the same sampling.
Real distance(const Rod& a, const Rod& b) {
  Real worst = 0;
  for (std::size_t i = 0; i < a.abscissa().size(); ++i)
    worst = std::max(worst, (a.poses(Configuration::current)[i].position -
                             b.poses(Configuration::current)[i].position)
                                .norm());
  return worst;
}

// The end of a step does not depend on how its forces became known.
TEST(RodStep, ForcesMayComeInChanges) {
  Rod at_once = thrown(0.1), in_parts = at_once;
  RodStep step(at_once);
  VecX force = VecX::Zero(at_once.dofs());
  force.segment<3>(6 * 12) = Vec3(0, 2e-5, -1e-5);
  force.segment<3>(6 * 30 + 3) = Vec3(1e-8, 0, 2e-8);
  ASSERT_GT(step.advance(at_once, 0.005, gravity, force, balanced), 0);
  VecX known = VecX::Zero(at_once.dofs());
  step = RodStep(in_parts);
  step.begin(in_parts, 0.005, gravity);
  for (int pass = 0; pass < 100; ++pass) {
    if (pass > 4 && step.imbalance(in_parts, force).relative <= balanced) break;
    ASSERT_TRUE(step.linearise(in_parts, known));
    const VecX change = pass < 4 ? VecX(0.25 * force) : VecX(VecX::Zero(force.size()));
    step.push(in_parts, change);
    step.correct(in_parts);
    known += change;
  }
  EXPECT_LE(step.imbalance(in_parts, force).relative, balanced);
  step.end(in_parts, force);
  // A hundred-thousandth of what is at work, 1 mN at most, on a rod of 16 mg that nothing but its
  // inertia holds: in 5 ms that is 1e-8 m, for each of the two.
  EXPECT_LT(distance(at_once, in_parts), 2e-8);
}

TEST(RodStep, TheMissingMomentumIsTheSlopeOfThePotential) {
  constexpr Real dt = 0.005;
  Rod rod = thrown(0.1);
  RodStep step(rod);
  for (int i = 0; i < 5; ++i) step.advance(rod, dt, gravity, VecX::Zero(rod.dofs()), balanced);
  step.damping.stiffness = 1e-3;
  // Slow, so that sections turn by 1e-4 in the step: so far is the derivative by the motion from
  // that by a further spin of the section.
  rod.velocity() *= 0.01;
  step.begin(rod, dt, Vec3::Zero());
  ASSERT_TRUE(step.linearise(rod, VecX::Zero(rod.dofs())));
  const VecX missing = step.guess().missing, motion = step.guess().motion;
  for (Index node = 0; node < rod.nodes(); node += 4) {
    Vec6 slope = Vec6::Zero();
    for (int k = 0; k < 6; ++k) {
      const Real size = dt * (k < 3 ? 1e-7 : 1e-4);
      for (const Real sign : {1., -1.}) {
        VecX other = motion;
        other[6 * node + k] += sign * size;
        step.move_to(rod, other);
        slope[k] += sign * dt * potential(rod, step.start(), step.guess()) / (2 * size);
      }
    }
    const Vec6 wrong = slope + missing.segment<6>(6 * node);
    EXPECT_LE(wrong.head<3>().norm(), 1e-3 * missing.segment<3>(6 * node).norm()) << node;
    EXPECT_LE(wrong.tail<3>().norm(), 1e-3 * missing.segment<3>(6 * node + 3).norm()) << node;
  }
}

TEST(RodStep, AStepBegunAnewForgetsTheFirstTry) {
  Rod once = thrown(0.2), again = once;
  const VecX none = VecX::Zero(once.dofs());
  RodStep step(once), second_try(again);
  second_try.begin(again, 0.02, gravity);
  for (int pass = 0; pass < 3; ++pass) {
    ASSERT_TRUE(second_try.linearise(again, none));
    second_try.correct(again);
  }
  const Index passes = step.advance(once, 0.005, gravity, none);
  EXPECT_EQ(second_try.advance(again, 0.005, gravity, none), passes);
  EXPECT_EQ(distance(once, again), 0);
  EXPECT_EQ(once.velocity(), again.velocity());
}

TEST(RodStep, AClampHoldsAndASpringPullsWithWhatItSays) {
  Rod rod;
  rod.build(straight_layout(0.1, 20, nylon()));
  rod.clamp(0);
  NodeSpring& spring = rod.springs().emplace_back();
  spring.node = 20;
  spring.active = true;
  spring.target = rod.poses(Configuration::current)[20];
  spring.target.position += Vec3(0, 0, 5e-3);
  spring.stiffness = {.translation = 2, .rotation = 1e-5};
  RodStep step(rod);
  const VecX none = VecX::Zero(rod.dofs());
  for (int i = 0; i < 400; ++i) {
    ASSERT_GT(step.advance(rod, 0.02, gravity, none, balanced), 0) << i;
    const auto& now = rod.poses(Configuration::current);
    ASSERT_EQ(now[0].position, Vec3(Vec3::Zero()));
    const Vec3 pull = 2 * (spring.target.position - now[20].position);
    EXPECT_LT((spring.applied.force - pull).norm(), 1e-15);
  }
  // At rest the matrix of the static problem agrees: what the step found is an equilibrium.
  const auto rested = rod.poses(Configuration::current)[20].position;
  ASSERT_TRUE(equilibrium(rod, gravity, none).converged);
  EXPECT_LT((rod.poses(Configuration::current)[20].position - rested).norm(), 1e-7);
}

// The gap of a cut has no chord: where one end flies off, that is no turn that shortens the way.
TEST(RodStep, WhatIsCutFliesApartInOneStep) {
  Rod rod;
  rod.build(straight_layout(0.1, 20, nylon()));
  rod.cut(9);
  const Vec3 speed(0, 3, 4);  // m/s: in a step ten times as far as a beam is long
  for (Index i = 10; i < rod.nodes(); ++i) rod.velocity().segment<3>(6 * i) = speed;
  RodStep step(rod);
  constexpr Real dt = 10e-3;
  const Index passes = step.advance(rod, dt, Vec3::Zero(), VecX::Zero(rod.dofs()));
  EXPECT_GT(passes, 0);
  EXPECT_LE(passes, 2);
  for (Index i = 0; i < rod.nodes(); ++i) {
    const Vec3 expected = Vec3(5e-3 * static_cast<Real>(i), 0, 0) + (i < 10 ? 0 : dt) * speed;
    EXPECT_LT((rod.poses()[i].position - expected).norm(), 1e-9) << i;
  }
}

}  // namespace
}  // namespace sutura::thread
