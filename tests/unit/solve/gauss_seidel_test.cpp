// The solver on problems of the kind a stitch makes, and what it promises: order and sweeps do not
// matter, events wait.
#include "solve/gauss_seidel.h"

#include <gtest/gtest.h>

#include "../plugins/suturing/puncture_law.h"
#include "solve_problems.h"
#include "sutura/laws/coulomb.h"
#include "sutura/laws/unilateral.h"

using namespace sutura;
using namespace sutura::test;

namespace {

SolveReport solve(ConstraintProblem& p, GaussSeidelOptions options = {}) {
  return BlockGaussSeidel(options).solve(p);
}

/// Largest amount by which any block misses its law, computed from W, d_free and lambda alone.
Real worst_stitch_error(const ConstraintProblem& p) {
  const VecX delta = p.W * p.lambda + p.d_free;
  Real worst = 0;
  for (const ConstraintBlock& b : p.blocks) {
    if (b.law->dim == 2) {
      worst = std::max(worst, delta.segment<2>(b.first_row).norm());
      continue;
    }
    const auto& f = *static_cast<const suturing::PathFrictionLaw::Params*>(p.block_params(b));
    const Real R = b.mode == suturing::PathFrictionLaw::stick ? f.static_level : f.kinetic;
    const Real lambda = p.lambda[b.first_row], slip = delta[b.first_row];
    // Either at rest with at most R, or at -sign(slip) (R + c |slip|): distance of the graph, as a
    // length.
    const Real at_rest = std::abs(lambda) <= R ? std::abs(slip) : 1e9;
    const Real sliding = std::abs(lambda + std::copysign(R + f.viscous * std::abs(slip), slip)) *
                         p.W(b.first_row, b.first_row);
    worst = std::max(worst, std::min(at_rest, sliding));
  }
  return worst;
}

TEST(GaussSeidel, SolvesStitchesInAHandfulOfSweeps) {
  // Sticking, part sliding, all sliding; dry and viscous. Plain sweeps have a violation above 20 mm
  // after 300.
  for (const int samples : {20, 50, 100, 150})
    for (const Real pull : {0.05, 0.3, 0.6, 1.2, 3.0})
      for (const Real viscous : {0.0, 0.5}) {
        ConstraintProblem p = stitch({.samples = samples, .pull = pull, .viscous = viscous});
        const SolveReport report = solve(p, {.tolerance = 1e-6});
        EXPECT_TRUE(report.converged) << samples << " " << pull << " " << viscous;
        EXPECT_LE(report.sweeps, 20);
        EXPECT_LE(report.direct_solves, 40);
        // Tolerance 1e-6 of 0.1 mm.
        EXPECT_LE(worst_stitch_error(p), 1.01e-10);
        if (viscous == 0 && pull > 1.5) {
          // Everything slides: the drag is the sum of kinetic levels.
          Real drag = 0, levels = 0;
          for (const ConstraintBlock& b : p.blocks)
            if (b.law->dim == 1) {
              drag -= p.lambda[b.first_row];
              levels +=
                  static_cast<const suturing::PathFrictionLaw::Params*>(p.block_params(b))->kinetic;
            }
          EXPECT_NEAR(drag, levels, 1e-9 * levels);
        }
      }
}

TEST(GaussSeidel, SolvesAThreadThatSlidesBothWaysOutOfItsPath) {
  // Pulled at both ends, the path slips forward on one side and backward on the other, and one or
  // two samples between hold what is left to balance the nearly free thread. Taking new tangents
  // everywhere at once cycles here: if no sample is taken to hold, the computed slips point the
  // wrong way. Met in the first stitch, when the tail was let go.
  for (const int samples : {16, 50, 100})
    for (const Real pull : {0.3, 1.0, 3.0})
      for (const Real share : {0.9, 0.99, 1.0}) {
        ConstraintProblem p = stitch({.samples = samples,
                                      .pull = pull,
                                      .pull_back = share * pull,
                                      .static_level = 0.0033,
                                      .kinetic = 0.0033});
        const SolveReport report = solve(p, {.tolerance = 1e-6});
        EXPECT_TRUE(report.converged)
            << samples << " " << pull << " " << share << " " << report.residual;
        EXPECT_LE(report.sweeps, 20);
        EXPECT_LE(worst_stitch_error(p), 1.01e-10);
      }
}

TEST(GaussSeidel, SolutionDoesNotDependOnOrderOrBudget) {
  ConstraintProblem first = stitch({.samples = 50, .pull = 0.3});
  solve(first, {.tolerance = 1e-7});
  for (const std::uint64_t seed : {2, 3, 4})
    for (const Index sweeps : {20, 200, 2000}) {
      ConstraintProblem p = stitch({.samples = 50, .pull = 0.3});
      const SolveReport report = solve(p, {.tolerance = 1e-7, .sweeps = sweeps, .seed = seed});
      EXPECT_TRUE(report.converged);
      for (std::size_t i = 0; i < p.blocks.size(); ++i)
        EXPECT_EQ(p.blocks[i].mode, first.blocks[i].mode);
      // 1e-11 m against an effective compliance of about 1e-3 m/N: 1e-8 N, with room for the sum
      // over samples.
      EXPECT_LT((p.lambda - first.lambda).lpNorm<Eigen::Infinity>(), 1e-7);
    }
}

TEST(GaussSeidel, WarmStartOfASolvedProblemCostsNoSweep) {
  ConstraintProblem p = stitch({.samples = 50, .pull = 0.3});
  solve(p);
  const VecX lambda = p.lambda;
  const SolveReport again = solve(p);
  EXPECT_EQ(again.sweeps, 0);
  EXPECT_EQ(again.direct_solves, 0);
  EXPECT_EQ(p.lambda, lambda);
}

TEST(GaussSeidel, EveryBlockKnowsItsViolation) {
  ConstraintProblem p = stitch({.samples = 20, .pull = 0.3});
  const SolveReport report = solve(p, {.sweeps = 3, .acceleration = Acceleration::none});
  ASSERT_FALSE(report.converged);
  Real largest = 0;
  for (const ConstraintBlock& b : p.blocks) {
    largest = std::max(largest, b.violation);
    if (b.law->dim != 2) continue;
    // A bilateral block without compliance is off by its delta: its law would take all of it away.
    EXPECT_NEAR(b.violation, p.delta.segment<2>(b.first_row).norm(), 1e-9 * report.violation);
  }
  EXPECT_EQ(largest, report.violation);
  EXPECT_GT(largest, 1e-6);
}

TEST(GaussSeidel, SameProblemAndSeedGiveTheSameBits) {
  ConstraintProblem a = stitch({.samples = 80, .pull = 0.6}),
                    b = stitch({.samples = 80, .pull = 0.6});
  BlockGaussSeidel used;  // has solved something else before
  ConstraintProblem other = stitch({.samples = 30});
  used.solve(other);
  used.solve(a);
  solve(b);
  EXPECT_EQ(a.lambda, b.lambda);
}

TEST(GaussSeidel, ConvergesWithoutTheDirectStepWhereSweepsCan) {
  // Diagonally dominant: every acceleration ends at the same point.
  std::mt19937_64 random(7);
  std::normal_distribution<Real> normal;
  const int n = 40;
  MatX B(n, n);
  for (Real& x : B.reshaped()) x = normal(random);
  const MatX W = 0.01 * (MatX(B * B.transpose()) / n + 2 * MatX::Identity(n, n));
  VecX d(n);
  for (Real& x : d) x = 1e-3 * normal(random);
  std::vector<VecX> lambda;
  for (const Acceleration a : {Acceleration::none, Acceleration::nncg, Acceleration::subspace}) {
    ConstraintProblem p;
    for (int i = 0; i < n; ++i) append<Unilateral>(p, {});
    finish(p, W, d);
    EXPECT_TRUE(solve(p, {.tolerance = 1e-8, .acceleration = a}).converged);
    lambda.push_back(p.lambda);
    EXPECT_GE(p.lambda.minCoeff(), 0);
    EXPECT_LT((p.lambda.array() * p.delta.array()).abs().maxCoeff(), 1e-11);
  }
  // 1e-8 * 1e-4 m over the smallest eigenvalue 0.02 m/N.
  EXPECT_LT((lambda[0] - lambda[1]).norm(), 1e-9);
  EXPECT_LT((lambda[0] - lambda[2]).norm(), 1e-9);
}

TEST(GaussSeidel, PunctureWaitsForTheConvergedForce) {
  // A tip held by a spring row whose share of the load is found only after many sweeps: two rows
  // along z, strongly coupled. Alone the surface would see 2 N; the hold takes half of it.
  // Threshold 1.5 N: no puncture. At 0.9 N: puncture.
  const Real c = 1e-4;
  for (const Real fp : {1.5, 0.9}) {
    ConstraintProblem p;
    append<suturing::PunctureLaw>(p, {.puncture_force = fp});
    append<Bilateral<1>>(p, {.compliance = c});
    MatX W = 1e-3 * MatX::Identity(4, 4);
    W(3, 3) = 1e-3;
    W(2, 3) = W(3, 2) = 1e-3 - 1e-9;
    VecX d(4);
    d << 0, 0, -2e-3, -1.95e-3;
    finish(p, W, d);
    // Exact: (W + diag(0, c)) (a, b) = (2e-3, 1.95e-3), solved here independently.
    Eigen::Matrix2d M;
    M << W(2, 2), W(2, 3), W(3, 2), W(3, 3) + c;
    const Vec2 exact = M.fullPivLu().solve(Vec2(2e-3, 1.95e-3));
    ASSERT_GT(exact[0], 0.9);
    const bool pierces = exact[0] > fp;
    for (const Acceleration a : {Acceleration::none, Acceleration::subspace}) {
      ConstraintProblem q = p;
      const SolveReport report = solve(q, {.tolerance = 1e-6, .acceleration = a});
      EXPECT_TRUE(report.converged);
      EXPECT_EQ(report.events, pierces ? 1 : 0);
      EXPECT_EQ(q.blocks[0].mode,
                pierces ? suturing::PunctureLaw::penetrated : suturing::PunctureLaw::pressing);
      if (!pierces) {
        EXPECT_NEAR(q.lambda[2], exact[0], 1e-3);
      } else {
        EXPECT_NEAR(q.lambda[2], 0, 1e-12);  // fc = 0
      }
    }
  }
}

// In a pass lambda is that of a guess: an event that is due waits until the step fires it.
TEST(GaussSeidel, EventsWaitWhereTheyAreHeld) {
  ConstraintProblem p;
  append<suturing::PunctureLaw>(p, {.puncture_force = 0.9});
  finish(p, 1e-3 * MatX::Identity(3, 3), Vec3(0, 0, -2e-3));
  p.hold_events = true;
  const SolveReport held = solve(p);
  EXPECT_TRUE(held.converged);
  EXPECT_EQ(held.events, 0);
  EXPECT_EQ(p.blocks[0].mode, suturing::PunctureLaw::yielding);
  EXPECT_NEAR(p.lambda[2], 0.9, 1e-12);  // all that the surface can bear
  EXPECT_EQ(fire_events(p), 1);
  EXPECT_EQ(p.blocks[0].mode, suturing::PunctureLaw::penetrated);
  EXPECT_EQ(fire_events(p), 0);
  // Held or not makes no difference once nothing is due.
  EXPECT_EQ(solve(p).events, 0);
  EXPECT_EQ(p.blocks[0].mode, suturing::PunctureLaw::penetrated);
}

TEST(GaussSeidel, ANonFiniteProblemIsReportedNotSpread) {
  ConstraintProblem p = stitch({.samples = 5});
  p.d_free[4] = std::numeric_limits<Real>::quiet_NaN();
  const SolveReport report = solve(p);
  EXPECT_FALSE(report.converged);
  EXPECT_TRUE(p.lambda.allFinite());
  // A warm start that is not finite does not poison a sound problem.
  ConstraintProblem q = stitch({.samples = 5});
  q.lambda[3] = std::numeric_limits<Real>::infinity();
  EXPECT_TRUE(solve(q).converged);
}

// A strand laid over a thicker one, held in two directions: friction lifts the touch by more than
// its own force presses it (mu |W_nt| > W_nn), so that W of the touch alone lets it stick where it
// slips. The law residual said so at the solution, and 1000 sweeps and 103 direct steps were in
// vain.
TEST(GaussSeidel, ATouchMayBeLiftedByItsFriction) {
  MatX W(5, 5);
  W << 0.260995, 0.533835, -0.00079971, -0.476089, 0.000862407,   //
      0.533835, 1.43742, 0.000337705, -1.44532, -0.000184862,     //
      -0.00079971, 0.000337705, 1.50316, -0.000354622, -1.50341,  //
      -0.476089, -1.44532, -0.000354622, 1.55448, 0.000194392,    //
      0.000862407, -0.000184862, -1.50341, 0.000194392, 1.51261;
  VecX d(5);
  d << -1.12147e-3, -2.04247e-4, -4.38742e-6, -1.98281e-4, 6.36718e-7;
  ConstraintProblem p;
  append<Coulomb>(p, {.mu = 0.5});
  append<Bilateral<1>>(p, {});
  append<Bilateral<1>>(p, {});
  finish(p, W, d);
  const SolveReport report = solve(p);
  EXPECT_TRUE(report.converged);
  EXPECT_LE(report.direct_solves, 10);
  const VecX delta = W * p.lambda + d;
  const Vec2 slip = delta.segment<2>(1), friction = p.lambda.segment<2>(1);
  EXPECT_GT(p.lambda[0], 0.01);
  EXPECT_NEAR(delta[0], 0, 1e-12);
  EXPECT_NEAR(friction.norm(), 0.5 * p.lambda[0], 1e-12);
  EXPECT_NEAR(slip.dot(friction), -slip.norm() * friction.norm(), 1e-12);
  EXPECT_GT(slip.norm(), 1e-5);
  EXPECT_NEAR(delta[3], 0, 1e-12);
  EXPECT_NEAR(delta[4], 0, 1e-12);
}

// Much friction and few modes: a third of these are not solved, whatever it costs.
TEST(GaussSeidel, ItIsBoundedWhatASolveMayCost) {
  constexpr int touches = 20, rows = 3 * touches;
  std::mt19937_64 random(3);
  std::normal_distribution<Real> normal;
  for (int n = 0; n < 60; ++n) {
    MatX modes(rows, 15 + 3 * (n % 10));
    for (Index i = 0; i < modes.size(); ++i) modes.data()[i] = normal(random);
    VecX d(rows);
    for (Index i = 0; i < rows; ++i) d[i] = 1e-3 * normal(random);
    ConstraintProblem p;
    for (int i = 0; i < touches; ++i) append<Coulomb>(p, {.mu = 1.0 + n % 3});
    finish(p, modes * modes.transpose() + 1e-6 * MatX::Identity(rows, rows), d);
    const SolveReport report = solve(p);
    EXPECT_LE(report.direct_solves, 1000) << n;
    EXPECT_LE(report.factorisations, 1000) << n;
    // Where it gives up it says so.
    EXPECT_EQ(report.converged, report.residual <= 1e-9) << n;
  }
}

}  // namespace
