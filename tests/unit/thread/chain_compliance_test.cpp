// The compliance of rows on a chain, against W = H A^-1 H^T with a dense inverse formed here.
#include "chain_compliance.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "solve/gauss_seidel.h"
#include "thread_problems.h"

namespace sutura::thread {
namespace {

constexpr Real dt = 0.1;

struct Chain {
  BlockTridiagonal matrix;
  MatX inverse;
  Chain(Index nodes, std::mt19937_64& random) {
    std::normal_distribution<Real> normal;
    MatX A = MatX::Zero(6 * nodes, 6 * nodes);
    for (Index i = 0; i + 1 < nodes; ++i) {
      Eigen::Matrix<Real, 8, 12> B;
      for (Real& x : B.reshaped()) x = normal(random);
      A.block<12, 12>(6 * i, 6 * i) += B.transpose() * B;
    }
    A.diagonal().array() += 0.1;
    matrix.resize(nodes);
    for (Index i = 0; i < nodes; ++i) {
      matrix.diagonal(i) = A.block<6, 6>(6 * i, 6 * i);
      if (i + 1 < nodes) matrix.upper(i) = A.block<6, 6>(6 * i, 6 * i + 6);
    }
    EXPECT_TRUE(matrix.factor());
    inverse = A.llt().solve(MatX::Identity(6 * nodes, 6 * nodes));
  }
};

struct Case {
  const char* name;
  Index nodes;
  std::vector<std::vector<Index>> rows;  ///< the nodes of each, in any order
  std::vector<Index> fixed = {};         ///< rows on these answer nothing
};

std::vector<Case> cases(std::mt19937_64& random) {
  std::vector<Case> all = {
      {"one node", 5, {{2}}},
      {"the ends", 9, {{0}, {8}}},
      {"two nodes", 4, {{1, 2}, {1, 2}, {2}}},
      {"self contact", 30, {{2, 3, 20, 21}, {4, 5, 18, 19}, {0, 29}, {21, 2, 3}}},
      {"a long interval", 16, {{2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, {12, 13}, {0, 1}}},
      {"fixed ends and middle", 20, {{0, 1}, {3, 4}, {10}, {9, 10}, {18, 19}}, {0, 10, 19}}};
  std::uniform_int_distribution<Index> beam(0, 48);
  for (const int count : {3, 17, 40}) {
    Case path{"random path", 50, {}};
    for (int i = 0; i < count; ++i) {
      const Index first = beam(random);
      path.rows.push_back({first, first + 1});
    }
    all.push_back(path);
  }
  return all;
}

// Sums of at most a hundred terms on chains whose condition is below 1e4: 1e-12 of the largest
// entry. (Not of each entry: W decays along the chain.)
TEST(ChainCompliance, IsThatOfTheDenseInverse) {
  std::mt19937_64 random(5);
  std::normal_distribution<Real> normal;
  ChainCompliance compliance;  // one for all: what it remembers of the last case must not matter
  for (const Case& c : cases(random)) {
    SCOPED_TRACE(c.name);
    const Chain chain(c.nodes, random);
    const auto n = static_cast<Index>(c.rows.size());
    BodyRows rows;
    rows.clear();
    rows.width = 6;
    MatX H = MatX::Zero(n + 1, 6 * c.nodes);
    for (Index i = 0; i < n; ++i) {
      rows.row.push_back(i + 1);  // row 0 is another body's
      for (const Index node : c.rows[static_cast<std::size_t>(i)]) {
        rows.node.push_back(node);
        for (int k = 0; k < 6; ++k) {
          rows.value.push_back(normal(random));
          H(i + 1, 6 * node + k) = rows.value.back();
        }
      }
      rows.start.push_back(static_cast<Index>(rows.node.size()));
    }
    for (const Index node : c.fixed) H.middleCols<6>(6 * node).setZero();
    const MatX expected = dt * dt * H * chain.inverse * H.transpose();
    const MatX before = MatX::Constant(n + 1, n + 1, 0.5);
    MatX W = before;
    compliance.add(chain.matrix, c.fixed, rows, dt, W);
    EXPECT_LT((W - before - expected).norm(), 1e-12 * (expected.norm() + 1));
    EXPECT_EQ(W, MatX(W.transpose()));
  }
}

TEST(ChainCompliance, DeltaIsWhatTheThreadDoes) {
  test::ThreadPath path({.beams = 60, .samples = 20, .tissue = false});
  ConstraintProblem problem;
  path.build(problem);
  EXPECT_TRUE(BlockGaussSeidel().solve(problem).converged);
  // By a solve with the whole factor; the condition of A is about 1e8.
  VecX force = VecX::Zero(path.thread.dofs()), delta = problem.d_free;
  problem.bodies[0].add_transposed(problem.lambda, force);
  MatX moved = force;
  path.thread.solve(moved);
  problem.bodies[0].add_product(0.01 * 0.01, moved.col(0), delta);
  EXPECT_LT((problem.delta - delta).lpNorm<Eigen::Infinity>(),
            1e-8 * problem.d_free.lpNorm<Eigen::Infinity>());
}

}  // namespace
}  // namespace sutura::thread
