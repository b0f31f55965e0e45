// What is measured after a pass, on problems whose answer can be said by hand.
#include "solve/law_check.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "solve/gauss_seidel.h"
#include "solve_problems.h"
#include "sutura/laws/coulomb.h"
#include "sutura/laws/unilateral.h"

using namespace sutura;
using namespace sutura::test;

namespace {

constexpr Real gap_tolerance = 1e-6;  // m

TEST(LawCheck, TakesOffWhatTheBodiesHaveAnsweredAlready) {
  ConstraintProblem p = stitch({.samples = 10});
  const VecX d_free = p.d_free;
  for (Index i = 0; i < p.rows(); ++i) p.lambda[i] = std::sin(static_cast<Real>(i));
  const VecX lambda = p.lambda;
  LawCheck().begin(p);
  const VecX expected = d_free - p.W * lambda;
  EXPECT_LT((p.d_free - expected).norm(), 1e-14 * expected.norm());
  EXPECT_EQ(p.lambda, lambda);
}

TEST(LawCheck, ASolvedProblemViolatesNothing) {
  ConstraintProblem p = stitch({.samples = 20, .pull = 0.3});
  LawCheck check;
  check.begin(p);
  BlockGaussSeidel solver;
  ASSERT_TRUE(solver.solve(p).converged);
  // The bodies did what W says: delta is what the solver has found, to its tolerance.
  const Residual residual = check.measure(p, gap_tolerance);
  EXPECT_LE(residual.value, solver.options().tolerance);
  EXPECT_LE(residual.violation, 1e-4 * solver.options().tolerance);
}

/// One unilateral row with compliance w under lambda, found at delta.
Real violation_of_contact(Real w, Real lambda, Real delta) {
  ConstraintProblem p;
  append<Unilateral>(p, {});
  finish(p, MatX::Constant(1, 1, w), VecX::Zero(1));
  LawCheck check;
  check.begin(p);
  p.lambda[0] = lambda;
  p.delta[0] = delta;
  const Real violation = check.measure(p, gap_tolerance).violation;
  EXPECT_EQ(p.blocks[0].violation, violation);
  EXPECT_EQ(p.lambda[0], lambda);
  return violation;
}

TEST(LawCheck, AContactIsOffByItsDepthOrByWhatItsForceHoldsOpen) {
  const Real w = 0.5;                                               // m/N
  EXPECT_EQ(violation_of_contact(w, 0, 2e-3), 0);                   // open
  EXPECT_NEAR(violation_of_contact(w, 0, -2e-3), 2e-3, 1e-15);      // inside, nothing pushes
  EXPECT_NEAR(violation_of_contact(w, 1, -2e-3), 2e-3, 1e-15);      // inside, pushed too little
  EXPECT_NEAR(violation_of_contact(w, 1, 2e-3), 2e-3, 1e-15);       // pushed off the surface
  EXPECT_NEAR(violation_of_contact(w, 1e-3, 2e-3), 0.5e-3, 1e-15);  // a force too weak for that
  EXPECT_EQ(violation_of_contact(w, 1, 0), 0);
}

TEST(LawCheck, AHoldIsOffByItsDelta) {
  ConstraintProblem p;
  append<Bilateral<2>>(p, {});
  append<Bilateral<1>>(p, {.compliance = 0.1});
  finish(p, 0.3 * MatX::Identity(3, 3), VecX::Zero(3));
  LawCheck check;
  check.begin(p);
  p.lambda << 1, -2, 5;
  p.delta << 3e-3, -4e-3, -0.5 + 1e-3;
  check.measure(p, gap_tolerance);
  EXPECT_NEAR(p.blocks[0].violation, 5e-3, 1e-15);
  // Compliant: delta = -c lambda is its law; of what is left the body takes W / (W + c).
  EXPECT_NEAR(p.blocks[1].violation, 1e-3 * 0.3 / 0.4, 1e-15);
}

// What misses its law by the same is nothing beside the tolerance of all, and ten times too much
// beside that of a block which asks for a hundredth of it.
TEST(LawCheck, ABlockMayAskForMore) {
  ConstraintProblem p;
  append<Bilateral<1>>(p, {});
  append<Bilateral<1>>(p, {});
  finish(p, MatX::Identity(2, 2), VecX::Zero(2));
  LawCheck check;
  check.begin(p);
  p.lambda.setZero();
  p.delta << 0.1 * gap_tolerance, 0.1 * gap_tolerance;
  EXPECT_NEAR(check.measure(p, gap_tolerance).relative, 0.1, 1e-15);
  p.blocks[1].precision = 0.01 * gap_tolerance;
  EXPECT_NEAR(check.measure(p, gap_tolerance).relative, 10, 1e-13);
  p.blocks[1].precision = 100 * gap_tolerance;  // never less than all are asked
  EXPECT_NEAR(check.measure(p, gap_tolerance).relative, 0.1, 1e-15);
}

TEST(LawCheck, TheModeIsOnlyAskedNotChanged) {
  ConstraintProblem p;
  append<Coulomb>(p, {.mu = 0.5}, static_cast<Mode>(Friction::stick));
  finish(p, MatX::Identity(3, 3), VecX::Zero(3));
  LawCheck check;
  check.begin(p);
  p.lambda << 1, 0.5, 0;
  p.delta << 0, -1, 0;  // slips with all its friction: on the graph, in another mode
  EXPECT_NEAR(check.measure(p, gap_tolerance).violation, 0, 1e-15);
  EXPECT_EQ(p.blocks[0].mode, static_cast<Mode>(Friction::stick));
}

// Blocks come and go between passes: each finds the compliance of its own key, a new one that of
// its units.
TEST(LawCheck, FindsTheComplianceByKey) {
  ConstraintProblem p;
  const Real w[3] = {0.1, 0.2, 0.4};
  for (int i = 0; i < 3; ++i) append<Unilateral>(p, {}, 0, {.force = 1, .length = 0.8});
  finish(p, Vec3(w[0], w[1], w[2]).asDiagonal(), VecX::Zero(3));
  LawCheck check;
  check.begin(p);
  std::swap(p.blocks[0].key, p.blocks[2].key);
  p.blocks[1].key = make_key(7, 7);
  p.lambda.setOnes();
  p.delta.setOnes();  // far off: violation = W lambda, of the W that counts
  check.measure(p, gap_tolerance);
  EXPECT_NEAR(p.blocks[0].violation, w[2], 1e-15);
  EXPECT_NEAR(p.blocks[1].violation, 0.8, 1e-15);
  EXPECT_NEAR(p.blocks[2].violation, w[0], 1e-15);
}

}  // namespace
