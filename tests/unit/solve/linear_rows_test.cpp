// Rows that are linear whatever the forces are: what is left without them, and what puts them back.
#include "solve/linear_rows.h"

#include <gtest/gtest.h>

#include "solve_problems.h"
#include "sutura/laws/coulomb.h"
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

}  // namespace
}  // namespace sutura::test
