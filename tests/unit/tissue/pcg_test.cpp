#include "pcg.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "recent_solutions.h"
#include "solver_fixture.h"

namespace sutura::tissue {
namespace {

using testing::Elasticity;
using testing::rough_vector;

class Conjugate : public ::testing::Test {
 protected:
  void SetUp() override {
    testing::assemble(grid, grid.rest, {}, 0.02, A0, rotations0);
    plan = make_factor_plan(A0.pattern(), grid.fixed, {}, default_backend());
    factor = make_factor(plan);
    ASSERT_TRUE(factor->factorise(A0));
  }
  /// Assembles A at the state and points the preconditioner from rest to it.
  void deform(const std::function<Vec3(const Vec3&)>& map) {
    testing::assemble(grid, testing::deform(grid, map), {}, 0.02, A, rotations);
    warped.set(*factor, rotations0, rotations);
  }
  testing::Grid grid = testing::make_grid(12, 3, 3, 0.005);
  NodeMatrix A0 = testing::make_matrix(grid), A = A0;
  std::vector<Mat3> rotations0, rotations;
  std::shared_ptr<const FactorPlan> plan;
  std::unique_ptr<Factor> factor;
  WarpedFactor warped;
  Pcg pcg;
};

TEST_F(Conjugate, StopsAtTheResidualItReports) {
  deform(testing::bend(0.06, 1.5, 0.0075));
  const VecX b = rough_vector(grid.fixed);
  for (const Real tolerance : {1e-2, 1e-5, 1e-10}) {
    GrowingMat x;
    const PcgReport r = pcg.solve(A, grid.fixed, warped, b, x, tolerance, 100);
    EXPECT_TRUE(r.converged);
    EXPECT_LE(r.residual, tolerance);
    const Real residual = (testing::dense(A, grid.fixed) * x - b).norm() / b.norm();
    // The recursive residual drifts from the true one by rounding times the size of A x.
    EXPECT_NEAR(residual, r.residual, 1e-12);
  }
}

TEST_F(Conjugate, OneIterationIfTheBodyOnlyTurned) {
  for (const Real degrees : {10.0, 90.0, 180.0, 275.0}) {
    const Eigen::AngleAxis<Real> turn(degrees * std::numbers::pi / 180, Vec3(1, 2, 3).normalized());
    deform([&](const Vec3& X) { return Vec3(turn * X + Vec3(0.1, -0.2, 0.05)); });
    GrowingMat x;
    const PcgReport r = pcg.solve(A, grid.fixed, warped, rough_vector(grid.fixed), x, 1e-9, 100);
    EXPECT_EQ(r.iterations, 1) << degrees;
  }
}

TEST_F(Conjugate, ManyColumnsGiveWhatEachGivesAlone) {
  deform(testing::twist(0.06, 1, Vec3(0, 0.0075, 0.0075)));
  MatX b(A.nodes() * 3, 4);
  GrowingMat together, alone;
  for (Index c = 0; c < 3; ++c) b.col(c) = rough_vector(grid.fixed, 7 + unsigned(c));
  b.col(3).setZero();
  pcg.solve(A, grid.fixed, warped, b, together, 1e-8, 100);
  for (Index c = 0; c < 4; ++c) {
    const PcgReport r = pcg.solve(A, grid.fixed, warped, b.col(c), alone, 1e-8, 100);
    EXPECT_EQ(r.iterations > 0, c < 3);
    // Both are within 1e-8 of A x = b in the residual; the factor's own rounding differs by
    // columns.
    EXPECT_LT((together.col(c) - alone.col(0)).norm(), 1e-8 * (1e-30 + alone.norm())) << c;
  }
}

TEST_F(Conjugate, AGoodStartSavesIterations) {
  deform(testing::bend(0.06, 1, 0.0075));
  const VecX b = rough_vector(grid.fixed);
  GrowingMat x;
  const Index cold = pcg.solve(A, grid.fixed, warped, b, x, 1e-8, 100).iterations;
  const PcgReport again = pcg.solve(A, grid.fixed, warped, b, x, 1e-7, 100, true);
  EXPECT_GT(cold, 0);
  EXPECT_EQ(again.iterations, 0);
  EXPECT_LE(again.residual, 1.1e-8);
}

TEST_F(Conjugate, RecentSolutionsSpanTheStart) {
  deform(testing::bend(0.06, 1, 0.0075));
  const VecX b1 = rough_vector(grid.fixed, 1), b2 = rough_vector(grid.fixed, 2);
  RecentSolutions recent;
  recent.reset(b1.size());
  GrowingMat x, start;
  EXPECT_FALSE(recent.start(A, grid.fixed, b1, start));
  for (const VecX* b : {&b1, &b2}) {
    pcg.solve(A, grid.fixed, warped, *b, x, 1e-10, 100);
    recent.add(x.col(0));
  }
  const VecX b = 0.3 * b1 - 2 * b2;
  ASSERT_TRUE(recent.start(A, grid.fixed, b, start));
  // What was solved before is known to 1e-10; the shift of the small system costs as much again.
  const PcgReport known = pcg.solve(A, grid.fixed, warped, b, start, 1e-8, 100, true);
  EXPECT_EQ(known.iterations, 0);
  // With another matrix the combination is chosen anew, and is never worse than starting from zero.
  testing::assemble(grid, grid.rest, {}, 0.02, A, rotations);
  recent.matrix_changed();
  ASSERT_TRUE(recent.start(A, grid.fixed, b, start));
  MatX exact = b;
  factor->solve(exact);
  const MatX D = testing::dense(A, grid.fixed), error = start - exact;
  EXPECT_LT((error.transpose() * D * error)(0), (exact.transpose() * D * exact)(0));
}

TEST_F(Conjugate, IgnoresWhatFixedNodesAreAsked) {
  deform(testing::bend(0.06, 1, 0.0075));
  VecX b = rough_vector(grid.fixed);
  GrowingMat x, y;
  pcg.solve(A, grid.fixed, warped, b, x, 1e-8, 100);
  b.segment<3>(0).setConstant(1e6);  // node 0 is fixed
  pcg.solve(A, grid.fixed, warped, b, y, 1e-8, 100);
  EXPECT_EQ(x, y);
  EXPECT_EQ(y.topRows(3).norm(), 0);
}

TEST_F(Conjugate, BlockJacobiNeedsNoFactor) {
  deform(testing::bend(0.06, 1, 0.0075));
  BlockJacobi jacobi;
  jacobi.compute(A, grid.fixed);
  const VecX b = rough_vector(grid.fixed);
  GrowingMat x, y;
  const PcgReport slow = pcg.solve(A, grid.fixed, jacobi, b, x, 1e-10, 2000);
  const PcgReport fast = pcg.solve(A, grid.fixed, warped, b, y, 1e-10, 100);
  EXPECT_TRUE(slow.converged && fast.converged);
  EXPECT_GT(slow.iterations, 5 * fast.iterations);
  // Residual 1e-10 times the condition number of A (some 1e3).
  EXPECT_LT((x - y).norm(), 1e-7 * y.norm());
}

TEST_F(Conjugate, ReportsWhatItCannotDo) {
  deform([](const Vec3& X) { return X; });
  const VecX b = rough_vector(grid.fixed);
  GrowingMat x;
  BlockJacobi jacobi;
  jacobi.compute(A, grid.fixed);
  const PcgReport few = pcg.solve(A, grid.fixed, jacobi, b, x, 1e-10, 3);
  EXPECT_FALSE(few.converged);
  EXPECT_EQ(few.iterations, 3);
  EXPECT_GT(few.residual, 1e-10);
  VecX broken = b;
  broken[100] = std::numeric_limits<Real>::quiet_NaN();
  EXPECT_FALSE(pcg.solve(A, grid.fixed, warped, broken, x, 1e-6, 100).converged);
  NodeMatrix negative = A;
  for (Index k = 0; k < 9 * A.pattern()->slots(); ++k) negative.values()[k] *= -1;
  EXPECT_FALSE(pcg.solve(negative, grid.fixed, warped, b, x, 1e-6, 100).converged);
  EXPECT_TRUE(x.allFinite());
}

}  // namespace
}  // namespace sutura::tissue
