// reference/c01, c06, c07: an incline, a pendulum, rows that repeat or contradict each other; small
// models on the same laws, builder and solver as any scene.
#include <gtest/gtest.h>

#include <numbers>

#include "csv.h"
#include "small_world.h"
#include "solve/gauss_seidel.h"
#include "solve_problems.h"
#include "sutura/laws/bilateral.h"
#include "sutura/laws/coulomb.h"

using namespace sutura;
using namespace sutura::test;
using sutura::testing::reference;
using sutura::testing::Table;

namespace {

TEST(Incline, SticksOrSlidesAsCoulombSays) {
  const Table table = reference("c01_incline.csv");
  ASSERT_EQ(table.rows.size(), 20u);
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const Real angle = table.number(row, "angle deg") * std::numbers::pi / 180,
               mu = table.number(row, "mu");
    const Real mass = 0.02, g = 9.81;
    PointMasses block(1, mass);
    // The plane is z = 0; gravity is tilted.
    SmallWorld world({&block}, {.gravity = Vec3(g * std::sin(angle), 0, -g * std::cos(angle))});
    Real friction = 0, normal = 0;
    for (int step = 0; step < 100; ++step) {
      BlockId id;
      world.step([&](ConstraintBuilder& builder) {
        const Vec3 now = block.position(0, Configuration::current);
        const Vec3 slip = now - block.position(0, Configuration::start);
        id = builder.add<Coulomb>({1}, {.mu = mu}, Vec3(now.z(), slip.x(), slip.y()));
        MatX rows(3, 3);
        rows << 0, 0, 1, 1, 0, 0, 0, 1, 0;
        world.couple(builder, id, block, 0, rows);
      });
      const SolvedBlocks solved(world.problem());
      normal = solved.lambda(id)[0];
      friction = solved.lambda(id).tail(2).norm();
    }
    const Real expected = table.number(row, "distance implicit Euler h=0.01");
    // The solver stops at 1e-9 of 0.1 mm and 0.1 N: friction is right to 1e-10 N, that is 5e-9
    // m/s^2 on 20 g.
    EXPECT_NEAR(block.x[0], expected, 1e-7) << "row " << row;
    if (table.number(row, "sticks") > 0) {
      EXPECT_LT(std::abs(block.v[0]), 1e-9);
    }
    EXPECT_NEAR(normal / mass, table.number(row, "normal force / m"), 1e-6);
    EXPECT_NEAR(friction / mass, table.number(row, "friction force / m"), 1e-6);
  }
}

TEST(Drift, APendulumKeepsItsLength) {
  const Table table = reference("c06_drift.csv");
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const Real h = table.number(row, "h s");
    // A row follows the bob while it turns: column c of the table, which keeps the length to
    // rounding, is met as closely as the passes are asked to.
    for (const Real asked : {1e-6, 1e-12}) {
      PointMasses bob(1, 0.1);
      bob.x << 1, 0, 0;
      // A force of 1 N and a length of 1 m: the solve is right to 1e-14 of them.
      SmallWorld world({&bob}, {.dt = h,
                                .gravity = Vec3(0, 0, -9.81),
                                .gap_tolerance = asked,
                                .solver_tolerance = 1e-14});
      Real worst = 0;
      const int steps = static_cast<int>(std::lround(10 / h));
      for (int step = 0; step < steps; ++step) {
        const StepReport& report = world.step([&](ConstraintBuilder& builder) {
          const Vec3 now = bob.position(0, Configuration::current);
          const BlockId id = builder.add<Bilateral<1>>({1}, {}, BlockVector<1>(now.norm() - 1), 0,
                                                       {.force = 1, .length = 1});
          world.couple(builder, id, bob, 0, now.normalized().transpose());
        });
        ASSERT_TRUE(report.solved) << h << ' ' << step;
        worst = std::max(worst, std::abs(bob.x.norm() - 1));
      }
      EXPECT_LT(worst, asked + table.number(row, "c worst")) << h;
    }
  }
}

// Two rows that say the same, or contradict each other, as two blocks with W = [[1, 1], [1, 1]].
ConstraintProblem twins(Real d1, Real d2, Bilateral<1>::Params params) {
  ConstraintProblem p;
  append<Bilateral<1>>(p, params, 0, {.force = 1, .length = 1});
  append<Bilateral<1>>(p, params, 0, {.force = 1, .length = 1});
  finish(p, MatX::Ones(2, 2), Vec2(d1, d2));
  return p;
}

TEST(Redundant, ConsistentTwinsShareTheForce) {
  for (const Acceleration a : {Acceleration::none, Acceleration::nncg, Acceleration::subspace}) {
    ConstraintProblem p = twins(1, 1, {});
    EXPECT_TRUE(BlockGaussSeidel({.tolerance = 1e-9, .acceleration = a}).solve(p).converged);
    EXPECT_NEAR(p.lambda.sum(), -1, 1e-9);
  }
}

TEST(Redundant, ConflictWithoutComplianceIsReportedAndBoundedByTheBudget) {
  ConstraintProblem p = twins(1, 2, {});
  const SolveReport report = BlockGaussSeidel({.sweeps = 200}).solve(p);
  EXPECT_FALSE(report.converged);
  ASSERT_TRUE(p.lambda.allFinite());
  // Each sweep adds at most the conflict itself, 1, and the direct step is taken only where the
  // residual falls.
  EXPECT_LE(p.lambda.cwiseAbs().maxCoeff(), 202);
  EXPECT_GT(report.residual, 0.4);
}

TEST(Redundant, ConflictWithComplianceFollowsTheClosedForm) {
  const Table table = reference("c07_redundant.csv");
  for (std::size_t row = 2; row < table.rows.size(); ++row) {
    const std::string name = table.text(row, "case");
    const Real e = std::stod(name.substr(name.find("compliance") + 11));
    ConstraintProblem p = twins(1, 2, {.compliance = e});
    const SolveReport report = BlockGaussSeidel({.tolerance = 1e-9}).solve(p);
    EXPECT_TRUE(report.converged) << name << report.residual;
    const Real scale = std::abs(table.number(row, "lambda2"));
    // Nine digits in the table; the residual tolerance 1e-9 over a compliance e.
    EXPECT_NEAR(p.lambda[0], table.number(row, "lambda1 (min norm)"), 1e-8 * scale + 2e-9 / e);
    EXPECT_NEAR(p.lambda[1], table.number(row, "lambda2"), 1e-8 * scale + 2e-9 / e);
    EXPECT_NEAR(p.delta.cwiseAbs().maxCoeff(), table.number(row, "residual"), 1e-6);
    EXPECT_LE(report.sweeps, 10);
  }
}

TEST(Redundant, ConflictWithACapIsBoundedByTheCap) {
  for (const Acceleration a : {Acceleration::none, Acceleration::subspace}) {
    ConstraintProblem p = twins(1, 2, {.cap = 10});
    EXPECT_TRUE(BlockGaussSeidel({.tolerance = 1e-9, .acceleration = a}).solve(p).converged);
    // The row with the larger gap pulls with its cap and still yields; the other holds.
    EXPECT_NEAR(p.lambda[1], -10, 1e-9);
    EXPECT_NEAR(p.lambda[0], 9, 1e-8);
    EXPECT_NEAR(p.delta[0], 0, 1e-8);
  }
}

}  // namespace
