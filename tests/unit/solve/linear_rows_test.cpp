// Rows that are linear whatever the forces are: what is left without them, and what puts them back.
#include "solve/linear_rows.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "solve/gauss_seidel.h"
#include "solve_problems.h"
#include "sutura/laws/coulomb.h"
#include "sutura/laws/turning_force.h"
#include "sutura/laws/unilateral.h"

namespace sutura::test {
namespace {

MatX random_matrix(Index rows, Index cols, std::mt19937_64& random) {
  std::normal_distribution<Real> normal;
  return MatX::NullaryExpr(rows, cols, [&] { return normal(random); });
}

/// Held and other blocks in turn; rows 0, 4 to 6 and 8, 9 are held without a cap.
ConstraintProblem mixed(std::mt19937_64& random) {
  ConstraintProblem p;
  append<Bilateral<1>>(p, {.compliance = 0.5});
  append<Coulomb>(p, {.mu = 0.3});
  append<Bilateral<3>>(p, {});
  append<Unilateral>(p, {});
  append<Bilateral<2>>(p, {.compliance = 0.1});
  append<Bilateral<2>>(p, {.cap = 1});
  const MatX B = random_matrix(12, 12, random);
  finish(p, B * B.transpose() + 0.1 * MatX::Identity(12, 12), random_matrix(12, 1, random));
  return p;
}

/// Whatever the others carry: the held rows are where their law wants them, and the others move as
/// the smaller problem says.
TEST(LinearRows, TheRestMovesAsInTheWholeProblem) {
  std::mt19937_64 random(1);
  for (int draw = 0; draw < 20; ++draw) {
    ConstraintProblem p = mixed(random), others;
    LinearRows rows;
    ASSERT_TRUE(rows.find(p) && rows.eliminate(p, others));
    ASSERT_EQ(others.rows(), 6);
    ASSERT_EQ(others.blocks.size(), 3u);
    others.lambda = random_matrix(6, 1, random);
    others.blocks[0].mode = 2;
    rows.put_back(others, p);
    EXPECT_EQ(p.blocks[1].mode, 2);

    const VecX delta = p.W * p.lambda + p.d_free, rest = others.W * others.lambda + others.d_free;
    VecX compliance = VecX::Zero(12);
    compliance[0] = 0.5, compliance[8] = compliance[9] = 0.1;
    const Index held[] = {0, 4, 5, 6, 8, 9}, other[] = {1, 2, 3, 7, 10, 11};
    // Rounding, times the condition of W: below 1e5.
    const Real rounding = 1e-11 * (1 + p.lambda.norm()) * p.W.norm();
    for (int i = 0; i < 6; ++i) {
      EXPECT_EQ(p.lambda[other[i]], others.lambda[i]);
      EXPECT_NEAR(delta[other[i]], rest[i], rounding);
      EXPECT_NEAR(delta[held[i]], -compliance[held[i]] * p.lambda[held[i]], rounding);
    }
    EXPECT_EQ(others.W, others.W.transpose());
  }
}

TEST(LinearRows, NothingIsEliminatedWhereThatIsOfNoUse) {
  ConstraintProblem held, capped;
  LinearRows rows;
  append<Bilateral<2>>(held, {});
  finish(held, Mat3::Identity().topLeftCorner<2, 2>(), Vec2::Ones());
  EXPECT_FALSE(rows.find(held)) << "there are no others";
  append<Bilateral<2>>(capped, {.cap = 1});
  append<Unilateral>(capped, {});
  finish(capped, Mat3::Identity(), Vec3::Ones());
  EXPECT_FALSE(rows.find(capped)) << "what has a cap is not linear";
}

/// Two rows that say the same cannot be told apart; the solver then takes the problem as a whole.
TEST(LinearRows, RowsThatRepeatEachOtherStay) {
  ConstraintProblem p, others;
  append<Bilateral<1>>(p, {});
  append<Bilateral<1>>(p, {});
  append<Unilateral>(p, {});
  Mat3 W = Mat3::Identity();
  W.topLeftCorner<2, 2>().setOnes();
  finish(p, W, Vec3::Ones());
  LinearRows rows;
  for (const Real rounding : {-1e-15, 0., 1e-15, 1e-13}) {
    W(1, 1) = 1 + rounding;
    p.W = W;
    ASSERT_TRUE(rows.find(p));
    EXPECT_FALSE(rows.eliminate(p, others)) << rounding;
  }
  W(1, 1) = 1 + 1e-9;
  p.W = W;
  EXPECT_TRUE(rows.find(p) && rows.eliminate(p, others));
}

/// A force that turns adds a stiffness that is positive one way and negative the other. It is taken
/// into account where the whole is stable: where A with all that is held is positive definite. Then
/// the others move as on that matrix. Else it is a spring, or nothing.
TEST(LinearRows, ForcesThatTurnAreEliminatedWhereAllIsStable) {
  std::mt19937_64 random(2);
  constexpr Index dofs = 8;
  int stable = 0, unstable = 0;
  for (int draw = 0; draw < 1000; ++draw) {
    ConstraintProblem p, others;
    const Real c = 0.5;
    std::uniform_real_distribution<Real> size(0, 2);
    const TurningForce::Params first{.stiffness = size(random), .coupling = size(random)},
        second{.stiffness = -size(random), .coupling = size(random)};
    append<TurningForce>(p, first);
    append<Bilateral<1>>(p, {.compliance = c});
    append<Coulomb>(p, {.mu = 0.3});
    append<TurningForce>(p, second);
    const MatX B = random_matrix(dofs, dofs, random), H = random_matrix(8, dofs, random);
    const MatX A = B * B.transpose() + MatX::Identity(dofs, dofs);
    const MatX inverse = A.inverse();
    const VecX free = random_matrix(dofs, 1, random);
    finish(p, H * inverse * H.transpose(), H * inverse * free);

    MatX K = MatX::Zero(8, 8);  // of the held rows
    K.topLeftCorner<2, 2>() << first.stiffness, first.coupling, first.coupling, 0;
    K(2, 2) = 1 / c;
    K.bottomRightCorner<2, 2>() << second.stiffness, second.coupling, second.coupling, 0;
    const MatX all = A + H.transpose() * K * H;
    const bool is_stable = all.llt().info() == Eigen::Success;
    ++(is_stable ? stable : unstable);

    LinearRows rows;
    ASSERT_TRUE(rows.find(p) && rows.eliminate(p, others));
    const Mode mode = is_stable ? TurningForce::whole : TurningForce::spring;
    EXPECT_EQ(p.blocks[0].mode, mode);
    EXPECT_EQ(p.blocks[3].mode, mode);
    ASSERT_EQ(others.rows(), is_stable ? 3 : 7);
    if (!is_stable) continue;
    const MatX rest = H.middleRows<3>(3);
    const MatX now = all.inverse();
    const Real rounding = 1e-9 * now.norm() * H.squaredNorm();
    EXPECT_LT((others.W - rest * now * rest.transpose()).norm(), rounding);
    EXPECT_LT((others.d_free - rest * now * free).norm(), rounding * free.norm());
    others.lambda = random_matrix(3, 1, random);
    rows.put_back(others, p);
    const VecX delta = p.W * p.lambda + p.d_free;
    for (const Index held : {0, 1, 2, 6, 7})
      EXPECT_NEAR(p.lambda[held], -K.row(held).dot(delta), rounding * (1 + p.lambda.norm()));
    rows.give_up(p);
    EXPECT_EQ(p.blocks[0].mode, TurningForce::spring);
  }
  EXPECT_GT(stable, 50);
  EXPECT_GT(unstable, 50);
}

/// Forces that turn along rows that are held. They have next to no W of their own: their pivots are
/// small, what these take from later ones is large, and elimination loses digits.
ConstraintProblem turning_along_held_rows(std::mt19937_64& random) {
  constexpr Index held = 60, turning = 10, other = 6, n = held + 2 * turning + other;
  ConstraintProblem p;
  for (Index i = 0; i < held; ++i) append<Bilateral<1>>(p, {});
  for (Index i = 0; i < turning; ++i) append<TurningForce>(p, {.stiffness = 0.1, .coupling = 0.1});
  for (Index i = 0; i < other; ++i) append<Unilateral>(p, {});
  MatX H = random_matrix(n, n, random);
  for (Index i = 0; i < turning; ++i) {
    auto row = H.row(held + 2 * i);
    row = 1e-5 * row + H.row(i);
  }
  finish(p, 1e-3 * H * H.transpose(), 1e-4 * random_matrix(n, 1, random));
  return p;
}

/// Solved again for what is left, the digits are back.
TEST(LinearRows, WhatRoundingLeavesIsSolvedAgain) {
  std::mt19937_64 random(3);
  for (int draw = 0; draw < 20; ++draw) {
    ConstraintProblem p = turning_along_held_rows(random), others;
    LinearRows rows;
    ASSERT_TRUE(rows.find(p) && rows.eliminate(p, others));
    ASSERT_EQ(p.blocks[60].mode, TurningForce::whole);
    const auto left = [&] {  // of the law residual, by held rows and those that turn
      Compliance compliance;
      GrowingVec plus;
      std::vector<Real> residual;
      compliance.prepare(p);
      compliance.update_delta(p);
      natural_map(p, compliance, plus, &residual);
      return *std::max_element(residual.begin(), residual.end() - others.rows());
    };
    const auto solve_others = [&] { others.lambda = 1e-3 * random_matrix(6, 1, random); };
    solve_others();
    rows.put_back(others, p);
    EXPECT_GT(left(), 1e-7) << "it is too easy";
    rows.refine(p, others);
    solve_others();
    rows.put_back(others, p);
    // Rounding, times what W loses where ten rows of it say nearly the same as ten others.
    EXPECT_LT(left(), 1e-9);
    const VecX delta = p.W * p.lambda + p.d_free, rest = others.W * others.lambda + others.d_free;
    EXPECT_LT((delta.tail(6) - rest).norm(), 1e-6 * rest.norm());
  }
}

/// No sweep finds forces that turn, so what rounding has left of them must not be left to sweeps:
/// they ran away to residuals of 1e123.
TEST(LinearRows, TheSolverSolvesAgainWhatRoundingLeaves) {
  std::mt19937_64 random(4);
  for (int draw = 0; draw < 20; ++draw) {
    ConstraintProblem p = turning_along_held_rows(random);
    const SolveReport report = BlockGaussSeidel({.tolerance = 1e-9}).solve(p);
    EXPECT_TRUE(report.converged) << report.residual;
    EXPECT_LE(report.sweeps, 5);
    EXPECT_EQ(p.blocks[60].mode, TurningForce::whole);
    EXPECT_LT(p.lambda.lpNorm<Eigen::Infinity>(), 1);  // N
  }
}

/// Nothing else may be left to solve: they are eliminated all the same, as no sweep finds them.
TEST(LinearRows, ForcesThatTurnMayBeAllThereIs) {
  ConstraintProblem p, others;
  append<Bilateral<1>>(p, {});
  append<TurningForce>(p, {.stiffness = 0.1, .coupling = 0.1});
  finish(p, Mat3::Identity(), Vec3::Ones());
  LinearRows rows;
  ASSERT_TRUE(rows.find(p) && rows.eliminate(p, others));
  EXPECT_EQ(others.rows(), 0);
  rows.put_back(others, p);
  EXPECT_EQ(p.blocks[1].mode, TurningForce::whole);
  // W is 1: (1 + K) lambda = -K d.
  BlockMatrix<2> K;
  K << 0.1, 0.1, 0.1, 0;
  const BlockVector<2> lambda =
      -(BlockMatrix<2>::Identity() + K).inverse() * K * BlockVector<2>::Ones();
  EXPECT_NEAR((p.lambda.tail<2>() - lambda).norm(), 0, 1e-12);
  EXPECT_NEAR(p.lambda[0], -1, 1e-12);
}

}  // namespace
}  // namespace sutura::test
