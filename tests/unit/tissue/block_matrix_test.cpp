#include "block_matrix.h"

#include <gtest/gtest.h>

#include "solver_fixture.h"

namespace sutura::tissue {
namespace {

using testing::make_grid;
using testing::rough_vector;

TEST(NodePattern, KeepsEachPairOnceAndEveryDiagonal) {
  const std::vector<std::array<Index, 2>> pairs{{2, 0}, {0, 2}, {3, 2}};
  const NodePattern p(5, pairs);
  EXPECT_EQ(p.slots(), 5 + 2);
  EXPECT_GE(p.slot(0, 2), 0);
  EXPECT_GE(p.slot(2, 3), 0);
  EXPECT_EQ(p.slot(0, 3), -1);
  for (Index i = 0; i < 5; ++i) EXPECT_EQ(p.slot(i, i), p.diagonal(i));
}

TEST(NodePattern, CouplesAllNodesOfAnElementOfAnySize) {
  const std::vector<Index> nodes{4, 1, 0, 2, 3, /**/ 1, 1, 5, 5, 0};  // repeated nodes are harmless
  const auto pairs = pairs_of_elements(nodes, 5);
  const std::vector<std::array<Index, 2>> expected{{0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}, {1, 2},
                                                   {1, 3}, {1, 4}, {1, 5}, {2, 3}, {2, 4}, {3, 4}};
  EXPECT_EQ(pairs, expected);
}

TEST(NodeMatrix, MultipliesLikeTheDenseMatrix) {
  const auto g = make_grid(3, 2, 2, 0.01);
  NodeMatrix A = testing::make_matrix(g);
  std::vector<Mat3> rotations;
  testing::assemble(g, testing::deform(g, testing::twist(0.03, 1, Vec3::Zero())), {}, 0.01, A,
                    rotations);
  const std::vector<char> none(g.rest.size(), 0);
  const MatX D = testing::dense(A, none);
  EXPECT_LT((D - D.transpose()).norm(), 1e-15 * D.norm());
  const VecX x = rough_vector(none);
  VecX y;
  A.multiply(x, y);
  // Two orders of about fifty additions of rounded products.
  EXPECT_LT((y - D * x).norm(), 1e-14 * (D.cwiseAbs() * x.cwiseAbs()).norm());
}

TEST(NodeMatrix, AddsAScaledDiagonal) {
  NodeMatrix A(3, std::vector<std::array<Index, 2>>{{0, 2}});
  A.add_diagonal(std::vector<Real>{1, 2, 3}, 0.5);
  EXPECT_EQ(A.block(1, 1), Mat3(Mat3::Identity()));
  EXPECT_EQ(A.block(2, 2), Mat3(1.5 * Mat3::Identity()));
  EXPECT_EQ(A.block(2, 0), Mat3(Mat3::Zero()));
}

}  // namespace
}  // namespace sutura::tissue
