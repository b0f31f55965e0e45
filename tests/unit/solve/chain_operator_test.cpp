// The operator of a chain against W = H A^-1 H^T formed here.
#include <gtest/gtest.h>

#include <functional>

#include "chain_problems.h"
#include "solve/compliance.h"

using namespace sutura;
using namespace sutura::test;

namespace {

struct Shape {
  const char* name;
  Index nodes;
  ChainRows rows;
};

/// Blocks on `count` random beams of the chain.
ChainRows path(Index nodes, int count, std::mt19937_64& random) {
  ChainRows rows;
  std::uniform_int_distribution<Index> beam(0, nodes - 2);
  for (int i = 0; i < count; ++i) {
    const Index first = beam(random);
    rows.nodes.push_back({first, first + 1});
  }
  return rows;
}

std::vector<Shape> shapes(std::mt19937_64& random) {
  std::vector<Shape> all = {
      {"one node", 5, {{{2}}, {}}},
      {"the ends", 9, {{{0}, {8}}, {}}},
      {"two nodes", 4, {{{1, 2}, {1, 2}, {2}}, {}}},
      {"all clamped but one", 3, {{{0, 1}, {1, 2}}, {0, 2}}},
      {"clamped ends and middle", 20, {{{0, 1}, {3, 4}, {9, 10}, {10, 11}, {18, 19}}, {0, 10, 19}}},
      {"self contact", 30, {{{2, 3, 20, 21}, {4, 5, 18, 19}, {0, 29}, {21, 2, 3}}, {}}},
      {"a block of another body", 12, {{{3, 4}, {}, {7, 8}}, {}}},
      {"a long interval", 16, {{{2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, {12, 13}, {0, 1}}, {}}},
      {"nodes of a block in any order", 16, {{{9, 3, 12}, {4, 3}}, {}}}};
  for (const int count : {3, 17, 40}) all.push_back({"random path", 50, path(50, count, random)});
  Shape mixed{"random path with self contacts and clamps", 40, path(40, 25, random)};
  mixed.rows.nodes[3] = {1, 2, 35, 36};
  mixed.rows.nodes[9] = {7, 8, 20, 21};
  mixed.rows.clamped = {0, 8, 21, 39};
  all.push_back(mixed);
  return all;
}

// Sums of at most a hundred terms on random chains whose condition is below 1e4, and the transfers
// of the test come from inverses of 6 x 6 blocks: 1e-12 of the largest entry. (Not of each entry: W
// decays along the chain.)
constexpr Real tolerance = 1e-12;

VecX random_vector(Index n, std::mt19937_64& random) {
  std::normal_distribution<Real> normal;
  VecX v(n);
  for (Real& x : v) x = normal(random);
  return v;
}

class ChainOperatorTest : public ::testing::Test {
 protected:
  void for_all(const std::function<void(ChainProblem&, ChainOperator&, std::mt19937_64&)>& test) {
    std::mt19937_64 random(5);
    ChainOperator op;  // one for all: what it remembers of the last problem must not matter
    for (const Shape& s : shapes(random)) {
      SCOPED_TRACE(s.name);
      ChainProblem c = chain_problem(s.nodes, s.rows, random);
      op.prepare(c.problem, c.problem.chains[0], c.problem.bodies[0]);
      test(c, op, random);
    }
  }
};

TEST_F(ChainOperatorTest, MultipliesByW) {
  for_all([](ChainProblem& c, ChainOperator& op, std::mt19937_64& random) {
    const VecX lambda = random_vector(c.W.rows(), random),
               start = random_vector(c.W.rows(), random);
    VecX delta = start;
    op.multiply(lambda, delta);
    EXPECT_LT((delta - start - c.W * lambda).lpNorm<Eigen::Infinity>(),
              tolerance * c.W.norm() * lambda.norm());
  });
}

TEST_F(ChainOperatorTest, GivesTheDiagonalBlocks) {
  for_all([](ChainProblem& c, ChainOperator& op, std::mt19937_64&) {
    for (std::size_t i = 0; i < c.problem.blocks.size(); ++i) {
      const Index row = c.problem.blocks[i].first_row;
      Mat3 block = Mat3::Constant(2);
      op.add_diagonal(i, block.data());
      EXPECT_LT((block - Mat3::Constant(2) - c.W.block<3, 3>(row, row)).norm(),
                tolerance * (c.W.norm() + 1));
      EXPECT_EQ(op.touches(i), (c.W.block<3, 3>(row, row).norm() > 0));
    }
  });
}

TEST_F(ChainOperatorTest, FollowsChangesOfForceInAnyOrder) {
  for_all([](ChainProblem& c, ChainOperator& op, std::mt19937_64& random) {
    VecX lambda = random_vector(c.W.rows(), random), delta = VecX::Zero(c.W.rows());
    op.multiply(lambda, delta);
    op.begin_sweep();
    std::uniform_int_distribution<std::size_t> some(0, c.problem.blocks.size() - 1);
    for (int visit = 0; visit < 200; ++visit) {
      const std::size_t i = some(random);
      const Index row = c.problem.blocks[i].first_row;
      Vec3 here = Vec3::Zero();
      op.add_displacement(i, here.data());
      EXPECT_LT((here - c.W.middleRows<3>(row) * lambda).norm(),
                tolerance * c.W.norm() * lambda.norm());
      const Vec3 change = random_vector(3, random);
      op.add_force(i, change.data());
      lambda.segment<3>(row) += change;
    }
    // The forces of the visits were added to those of the product before; a new product starts from
    // lambda alone.
    delta.setZero();
    op.multiply(lambda, delta);
    EXPECT_LT((delta - c.W * lambda).norm(), tolerance * c.W.norm() * lambda.norm());
  });
}

TEST_F(ChainOperatorTest, AssemblesW) {
  for_all([](ChainProblem& c, ChainOperator& op, std::mt19937_64&) {
    MatX W = MatX::Zero(c.W.rows(), c.W.cols());
    op.add_lower_triangle(W);
    EXPECT_EQ(MatX(W.triangularView<Eigen::StrictlyUpper>()).norm(), 0);
    mirror_lower_triangle(W);
    EXPECT_LT((W - c.W).norm(), tolerance * c.W.norm());
    EXPECT_LT((assembled_compliance(c.problem) - c.W).norm(), tolerance * c.W.norm());
  });
}

TEST_F(ChainOperatorTest, FormsTheProductsOfCombinations) {
  for_all([](ChainProblem& c, ChainOperator& op, std::mt19937_64& random) {
    // Two combinations for most blocks, none for every fifth; on its places a matrix with room to
    // spare.
    std::vector<RowCombination> all;
    std::vector<Vec3> move, test;
    move.reserve(2 * c.problem.blocks.size());
    test.reserve(2 * c.problem.blocks.size());
    Index at = 1;
    for (std::size_t i = 0; i < c.problem.blocks.size(); ++i)
      for (int k = 0; k < 2 && i % 5 != 4; ++k) {
        move.push_back(random_vector(3, random));
        test.push_back(random_vector(3, random));
        all.push_back({i, move.back().data(), test.back().data(), at++});
      }
    MatX M = MatX::Zero(c.W.rows(), at), T = M;
    for (const RowCombination& r : all) {
      const Index row = c.problem.blocks[r.block].first_row;
      M.col(r.at).segment<3>(row) = Eigen::Map<const Vec3>(r.move);
      T.col(r.at).segment<3>(row) = Eigen::Map<const Vec3>(r.test);
    }
    const MatX expected = T.transpose() * c.W * M;
    MatX G = MatX::Zero(at, at);
    op.add_products(all, false, G);
    EXPECT_LT((G - expected).norm(), tolerance * M.norm() * T.norm() * c.W.norm());
    for (RowCombination& r : all) r.test = r.move;
    G.setZero();
    op.add_products(all, true, G);
    const MatX symmetric = (M.transpose() * c.W * M).triangularView<Eigen::Lower>();
    EXPECT_LT((G - symmetric).norm(), tolerance * M.squaredNorm() * c.W.norm());
  });
}

}  // namespace
