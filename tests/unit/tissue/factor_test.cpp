#include "factor.h"

#include <gtest/gtest.h>

#include <limits>

#include "solver_fixture.h"

// Only where the BLAS of this build is OpenBLAS.
extern "C" void openblas_set_num_threads(int) __attribute__((weak));
extern "C" int openblas_get_num_threads() __attribute__((weak));

namespace sutura::tissue {
namespace {

class FactorOf : public ::testing::TestWithParam<FactorBackend> {
 protected:
  void SetUp() override {
    if (!has_backend(GetParam())) GTEST_SKIP() << "not in this build";
    testing::assemble(grid, grid.rest, {}, 0.01, A, rotations);
  }
  std::unique_ptr<Factor> factor(std::span<const Index> last = {}) {
    plan = make_factor_plan(A.pattern(), grid.fixed, last, GetParam());
    return make_factor(plan);
  }
  testing::Grid grid = testing::make_grid(6, 4, 4, 0.005);
  NodeMatrix A = testing::make_matrix(grid);
  std::vector<Mat3> rotations;
  std::shared_ptr<const FactorPlan> plan;
};

// Backward stable solves err by a small multiple of the condition number (here some 1e3) times
// 1e-16.
constexpr Real solve_tolerance = 1e-11;

TEST_P(FactorOf, SolvesManyColumnsLikeADenseMatrix) {
  const auto f = factor();
  ASSERT_TRUE(f->factorise(A));
  MatX b(3 * A.nodes(), 3);
  for (Index c = 0; c < 3; ++c) b.col(c) = testing::rough_vector(grid.fixed, 1 + unsigned(c));
  const MatX expected = testing::dense(A, grid.fixed).llt().solve(b);
  MatX x = b;
  f->solve(x);
  EXPECT_LT((x - expected).norm(), solve_tolerance * expected.norm());
}

// The number of threads is a setting of the whole process, and so the host's.
TEST_P(FactorOf, LeavesTheThreadsOfBlasAsTheHostHasSetThem) {
  const bool openblas = openblas_set_num_threads && openblas_get_num_threads;
  if (openblas) openblas_set_num_threads(2);
  const auto f = factor();
  ASSERT_TRUE(f->factorise(A));
  MatX x = testing::rough_vector(grid.fixed);
  f->solve(x);
  if (openblas) {
    EXPECT_EQ(openblas_get_num_threads(), 2);
  }
}

TEST_P(FactorOf, RoughSolvesAreGoodToSinglePrecision) {
  const auto f = factor();
  f->keep_rough();
  ASSERT_TRUE(f->factorise(A));
  MatX exact = 1e-50 * testing::rough_vector(grid.fixed),
       rough = exact;  // below the range of float
  exact.col(0).segment<3>(3).setConstant(7e-51);
  rough = exact;
  f->solve(exact);
  f->solve_roughly(rough);
  // 6e-8 times a condition number of some 1e3, had the errors all added up.
  EXPECT_LT((rough - exact).norm(), 6e-5 * exact.norm());
  MatX zero = MatX::Zero(3 * A.nodes(), 1);
  f->solve_roughly(zero);
  EXPECT_EQ(zero.norm(), 0);
}

TEST_P(FactorOf, FixedNodesAnswerZeroToAnyForce) {
  const auto f = factor();
  ASSERT_TRUE(f->factorise(A));
  MatX x = MatX::Zero(3 * A.nodes(), 1);
  for (std::size_t i = 0; i < grid.fixed.size(); ++i)
    if (grid.fixed[i]) x.col(0).segment<3>(3 * Index(i)).setConstant(1e3);
  f->solve(x);
  EXPECT_EQ(x.norm(), 0);
}

TEST_P(FactorOf, TailComplianceIsTheBlockOfTheInverse) {
  // The free corner nodes, in an order of our own, and a fixed one that must be left out.
  const std::vector<Index> last{174, 6, 34, 0, 146, 30, 100};
  const auto f = factor(last);
  ASSERT_TRUE(f->factorise(A));
  const auto candidates = candidates_of(*plan);
  ASSERT_EQ(candidates.size(), last.size() - 1);
  const MatX inverse =
      testing::dense(A, grid.fixed).llt().solve(MatX::Identity(3 * A.nodes(), 3 * A.nodes()));
  MatX C;
  f->candidate_compliance(C);
  ASSERT_EQ(C.rows(), 3 * Index(candidates.size()));
  Real worst = 0;
  for (std::size_t a = 0; a < candidates.size(); ++a)
    for (std::size_t b = 0; b < candidates.size(); ++b)
      worst = std::max(worst, (C.block<3, 3>(3 * Index(a), 3 * Index(b)) -
                               inverse.block<3, 3>(3 * candidates[a], 3 * candidates[b]))
                                  .norm());
  EXPECT_LT(worst, solve_tolerance * C.norm());
}

TEST_P(FactorOf, OrderingCandidatesLastChangesNothingElse) {
  std::vector<Index> last;
  for (Index i = 0; i < A.nodes(); i += 3) last.push_back(i);
  const auto plain = factor();
  const auto with_candidates_last = factor(last);
  ASSERT_TRUE(plain->factorise(A) && with_candidates_last->factorise(A));
  MatX x = testing::rough_vector(grid.fixed), y = x;
  plain->solve(x);
  with_candidates_last->solve(y);
  EXPECT_LT((x - y).norm(), solve_tolerance * x.norm());
}

TEST_P(FactorOf, ReportsAMatrixThatIsNotPositiveDefiniteAndRecovers) {
  const auto f = factor();
  NodeMatrix bad = A;
  bad.values()[9 * bad.pattern()->diagonal(100)] *= -1;
  EXPECT_FALSE(f->factorise(bad));
  bad.values()[9 * bad.pattern()->diagonal(100)] = std::numeric_limits<Real>::quiet_NaN();
  EXPECT_FALSE(f->factorise(bad));
  ASSERT_TRUE(f->factorise(A));
  MatX x = testing::rough_vector(grid.fixed);
  const VecX b = x.col(0);
  f->solve(x);
  EXPECT_LT((testing::dense(A, grid.fixed) * x - b).norm(), solve_tolerance * b.norm());
}

TEST_P(FactorOf, ABodyWithoutFreeNodesIsNoError) {
  std::fill(grid.fixed.begin(), grid.fixed.end(), 1);
  const auto f = factor();
  EXPECT_TRUE(f->factorise(A));
  MatX x = MatX::Ones(3 * A.nodes(), 2);
  f->solve(x);
  EXPECT_EQ(x.norm(), 0);
}

INSTANTIATE_TEST_SUITE_P(Backends, FactorOf,
                         ::testing::Values(FactorBackend::cholmod, FactorBackend::eigen),
                         [](const auto& info) {
                           return info.param == FactorBackend::cholmod ? "cholmod" : "eigen";
                         });

}  // namespace
}  // namespace sutura::tissue
