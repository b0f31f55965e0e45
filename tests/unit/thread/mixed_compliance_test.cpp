// One solve with the thread as an operator beside assembled tissue, against the same solve with
// everything in W.
#include <gtest/gtest.h>

#include "solve/gauss_seidel.h"
#include "solve/reference_solver.h"
#include "thread_problems.h"

using namespace sutura;
using namespace sutura::test;

namespace {

// The rows of W are 1e3 times apart in size (a free thread against tissue), and lambda adds 60 of
// them: rounding moves delta by about 1e-13 of itself. A sweep passes that on, neither better nor
// worse.
constexpr Real rounding = 1e-11;

VecX iterate(ConstraintProblem problem, Acceleration acceleration, Index sweeps) {
  BlockGaussSeidel({.tolerance = 1e-14, .sweeps = sweeps, .acceleration = acceleration})
      .solve(problem);
  return problem.lambda;
}

TEST(MixedCompliance, IteratesAreThoseOfTheAssembledSolve) {
  for (const bool tissue : {true, false}) {
    ThreadPath path({.beams = 60, .samples = 20, .tissue = tissue});
    ConstraintProblem assembled, mixed;
    path.build(assembled, ComplianceForm::assembled);
    path.build(mixed, ComplianceForm::as_operator);
    ASSERT_EQ(assembled.W.rows(), 60);
    EXPECT_EQ(mixed.W.rows(), tissue ? 60 : 0);  // the thread's share is built by nobody
    if (tissue) {
      EXPECT_LT(mixed.W.cwiseAbs().maxCoeff(), 0.011);  // of the tissue alone
    }
    for (const Acceleration a : {Acceleration::none, Acceleration::nncg})
      for (Index sweeps = 1; sweeps <= 20; ++sweeps) {
        const VecX one = iterate(assembled, a, sweeps), other = iterate(mixed, a, sweeps);
        EXPECT_GT(one.norm(), 0.01);
        EXPECT_LT((one - other).norm(), rounding * one.norm()) << int(a) << " " << sweeps;
      }
  }
}

TEST(MixedCompliance, TheDirectStepIsThatOfTheAssembledSolve) {
  // The condition of the system, scaled to a unit diagonal, is below 1e8 here: what rounding leaves
  // is below 1e-8.
  ThreadPath path({.beams = 60, .samples = 20});
  ConstraintProblem assembled, mixed;
  path.build(assembled, ComplianceForm::assembled);
  path.build(mixed, ComplianceForm::as_operator);
  for (Index sweeps = 1; sweeps <= 20; ++sweeps) {
    ConstraintProblem a = assembled, b = mixed;
    const GaussSeidelOptions options{.tolerance = 1e-9, .sweeps = sweeps};
    const SolveReport one = BlockGaussSeidel(options).solve(a),
                      other = BlockGaussSeidel(options).solve(b);
    EXPECT_EQ(one.sweeps, other.sweeps);
    EXPECT_EQ(one.direct_solves, other.direct_solves);
    EXPECT_EQ(one.converged, other.converged);
    EXPECT_LT((a.lambda - b.lambda).norm(), 1e-8 * a.lambda.norm());
    for (std::size_t i = 0; i < a.blocks.size(); ++i) EXPECT_EQ(a.blocks[i].mode, b.blocks[i].mode);
  }
  ConstraintProblem a = assembled, b = mixed;
  EXPECT_TRUE(BlockGaussSeidel().solve(a).converged);
  EXPECT_TRUE(ReferenceSolver().solve(b).converged);
  // Two solvers, to 1e-5 * 1e-4 m against an effective compliance of 1e-3 m/N and above.
  EXPECT_LT((a.lambda - b.lambda).lpNorm<Eigen::Infinity>(), 1e-6);
}

TEST(MixedCompliance, DeltaIsWhatTheThreadDoes) {
  ThreadPath path({.beams = 60, .samples = 20, .tissue = false});
  ConstraintProblem problem;
  path.build(problem, ComplianceForm::as_operator);
  EXPECT_TRUE(BlockGaussSeidel().solve(problem).converged);
  // By a solve with the whole factor; the condition of A is about 1e8.
  VecX force = VecX::Zero(path.thread.dofs()), delta = problem.d_free;
  problem.bodies[0].add_transposed(problem.lambda, force);
  MatX moved = 0.01 * 0.01 * force;
  path.thread.solve(moved);
  problem.bodies[0].add_product(moved.col(0), delta);
  EXPECT_LT((problem.delta - delta).lpNorm<Eigen::Infinity>(),
            1e-8 * problem.d_free.lpNorm<Eigen::Infinity>());
}

TEST(MixedCompliance, ASweepCostsTheSameOnAThreadOfAnyLength) {
  Index products = 0;
  for (const Index beams : {200, 1000, 5000}) {
    ThreadPath path({.beams = beams, .samples = 50});
    ConstraintProblem problem;
    path.build(problem, ComplianceForm::as_operator);
    Compliance compliance;
    compliance.prepare(problem);
    compliance.update_delta(problem);
    const ChainOperator& chain = compliance.operators()[0];
    const Index before = chain.products();
    compliance.begin_sweep();
    for (std::size_t i = problem.blocks.size(); i-- > 0;) {
      Real delta[max_block_dim] = {};
      compliance.displacement(problem, i, delta);
      compliance.add_change(problem, i, delta);
    }
    compliance.end_sweep(problem);
    const Index count = chain.products() - before;
    // 51 touched nodes: 6 levels. A visit of two neighbours goes up and down once and has eight
    // products at the two leaves, and the two ways part half a level to one level above them on
    // average; begin and end together are less than ten products per node.
    EXPECT_LT(count, 100 * (2 * 6 + 8 + 2 * 2) + 10 * 64);
    EXPECT_GT(count, 100 * (2 * 5 + 8));
    if (beams > 200) {
      EXPECT_EQ(count, products);
    }
    products = count;
  }
}

TEST(MixedCompliance, TheFormIsChosenByCount) {
  const auto report = [](ThreadPathOptions options, const SolveReport& last) {
    ThreadPath path(options);
    path.last = last;
    ConstraintProblem problem;
    path.build(problem, ComplianceForm::automatic);
    EXPECT_EQ(problem.chains[0].empty(), !path.report.as_operator);
    EXPECT_EQ(path.report.as_operator, path.report.operator_count < path.report.assembled_count);
    EXPECT_GT(path.report.operator_count, 0);
    return path.report;
  };
  // Nothing to do but one look at delta: n^2 numbers would be made for nothing.
  EXPECT_TRUE(report({.samples = 50}, {}).as_operator);
  // Many sweeps over few rows: columns of W are short.
  EXPECT_FALSE(report({.samples = 20}, {.sweeps = 100}).as_operator);
  // New matrices are quickly taken out of a W that is there.
  EXPECT_FALSE(report({.samples = 50}, {.sweeps = 2, .direct_solves = 10, .factorisations = 10})
                   .as_operator);
  // Thousands of rows: a sweep over columns costs their square.
  EXPECT_TRUE(
      report({.beams = 1100, .samples = 1000, .tissue = false}, {.sweeps = 20}).as_operator);
  // A dense W is there anyway, for tissue: only what the thread adds to it counts, and its sweeps
  // are free.
  const SolveReport sweeps{.sweeps = 50};
  EXPECT_GT(report({.samples = 50, .tissue = false}, sweeps).assembled_count,
            report({.samples = 50, .tissue = true}, sweeps).assembled_count);
  // The length of the thread does not enter.
  EXPECT_EQ(report({.beams = 200}, sweeps).operator_count,
            report({.beams = 1000}, sweeps).operator_count);
}

}  // namespace
