#include "block_tridiagonal.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

namespace sutura::thread {
namespace {

/// A random positive definite chain, and the same matrix dense.
struct Chain {
  BlockTridiagonal matrix;
  MatX dense;
  explicit Chain(Index blocks, unsigned seed = 3) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<Real> uniform(-1, 1);
    const auto random = [&] { return uniform(engine); };
    matrix.resize(blocks);
    matrix.set_zero();
    dense.setZero(6 * blocks, 6 * blocks);
    for (Index i = 0; i + 1 < blocks; ++i) {
      const Eigen::Matrix<Real, 12, 12> r = Eigen::Matrix<Real, 12, 12>::NullaryExpr(random);
      const Eigen::Matrix<Real, 12, 12> k = r.transpose() * r;
      matrix.diagonal(i) += k.topLeftCorner<6, 6>();
      matrix.upper(i) += k.topRightCorner<6, 6>();
      matrix.diagonal(i + 1) += k.bottomRightCorner<6, 6>();
      dense.block<12, 12>(6 * i, 6 * i) += k;
    }
    for (Index i = 0; i < blocks; ++i) matrix.diagonal(i) += Mat6::Identity();
    dense += MatX::Identity(6 * blocks, 6 * blocks);
  }
};

// Condition numbers here are below 1e3: 1e-12 is a thousand roundings.
constexpr Real tolerance = 1e-12;

TEST(BlockTridiagonal, SolvesAsADenseFactorisation) {
  for (const Index n : {1, 2, 3, 20}) {
    Chain c(n);
    ASSERT_TRUE(c.matrix.factor());
    const VecX b = VecX::LinSpaced(6 * n, -1, 2);
    VecX x = b;
    c.matrix.solve(Eigen::Ref<VecX>(x));
    const VecX expected = c.dense.llt().solve(b);
    EXPECT_LT((x - expected).norm(), tolerance * expected.norm());
    VecX back(6 * n);
    c.matrix.multiply(x, back);
    EXPECT_LT((back - b).norm(), tolerance * b.norm());
  }
}

// As a long beam of a fine thread is: stiff along its chord, which lies along no axis, and a
// million times softer across. Inverses by cofactors lose the square of that ratio, 12 digits of
// 16, and here the rest through the chain: the answer was off by 8 %.
TEST(BlockTridiagonal, KeepsItsDigitsWhereBeamsAreMuchStifferAlong) {
  constexpr Index n = 12;
  constexpr Real soft = 1e-6;
  BlockTridiagonal matrix;
  matrix.resize(n);
  matrix.set_zero();
  using Exact = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  Exact dense = Exact::Zero(6 * n, 6 * n);
  for (Index i = 0; i < n; ++i) {
    Mat6 own = Mat6::Identity() * soft;
    if (i + 1 < n) {
      const Real angle = 0.3 * static_cast<Real>(i);
      const Vec3 along(std::cos(angle), std::sin(angle) / 3, std::sin(2 * angle) / 2);
      Mat6 link = Mat6::Zero();
      link.topLeftCorner<3, 3>() = along * along.transpose();
      own += link;
      matrix.upper(i) = -link;
      matrix.diagonal(i + 1) += link;
      dense.block<6, 6>(6 * i + 6, 6 * i + 6) += link.cast<long double>();
      dense.block<6, 6>(6 * i, 6 * i + 6) -= link.cast<long double>();
      dense.block<6, 6>(6 * i + 6, 6 * i) -= link.cast<long double>();
    }
    matrix.diagonal(i) += own;
    dense.block<6, 6>(6 * i, 6 * i) += own.cast<long double>();
  }
  ASSERT_TRUE(matrix.factor());
  VecX x = VecX::LinSpaced(6 * n, -1, 2);
  const VecX expected = dense.llt().solve(x.cast<long double>().matrix()).cast<Real>();
  matrix.solve(Eigen::Ref<VecX>(x));
  EXPECT_LT((x - expected).norm() / expected.norm(), 1e-5);
}

TEST(BlockTridiagonal, ManyColumnsEqualSingleOnes) {
  Chain c(15);
  ASSERT_TRUE(c.matrix.factor());
  const MatX b = MatX::Random(90, 19);
  MatX x = b;
  c.matrix.solve(Eigen::Ref<MatX>(x));
  for (Index j = 0; j < b.cols(); ++j) {
    VecX one = b.col(j);
    c.matrix.solve(Eigen::Ref<VecX>(one));
    EXPECT_LT((x.col(j) - one).norm(), tolerance * one.norm());
  }
}

TEST(BlockTridiagonal, CondensedBlocksAreThoseOfTheInverse) {
  Chain c(12);
  ASSERT_TRUE(c.matrix.factor());
  const MatX inverse = c.dense.inverse();
  for (const std::vector<Index>& nodes :
       {std::vector<Index>{0, 3, 4, 9}, {11}, {0, 11}, {2, 3, 4, 5, 10, 11}, {}}) {
    std::vector<Mat6> own, transfer;
    c.matrix.condense(nodes, own, transfer);
    ASSERT_EQ(own.size(), nodes.size());
    if (!nodes.empty()) {
      EXPECT_EQ(transfer.back().norm(), 0);
    }
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      Mat6 block = own[j];
      for (std::size_t i = j + 1; i-- > 0;) {
        if (i < j) block = (transfer[i] * block).eval();
        EXPECT_LT((block - inverse.block<6, 6>(6 * nodes[i], 6 * nodes[j])).norm(),
                  tolerance * inverse.norm());
      }
    }
  }
}

TEST(BlockTridiagonal, RefusesAnIndefiniteMatrix) {
  Chain c(8);
  c.matrix.diagonal(5) -= 50 * Mat6::Identity();
  EXPECT_FALSE(c.matrix.factor());
  Chain d(8);
  d.matrix.diagonal(2)(1, 1) = std::nan("");
  EXPECT_FALSE(d.matrix.factor());
}

TEST(BlockTridiagonal, FixedDofsAnswerZero) {
  Chain c(6);
  for (int d = 0; d < 6; ++d) c.matrix.fix(2, d);
  ASSERT_TRUE(c.matrix.factor());
  VecX x = VecX::Ones(36);
  x.segment<6>(12).setZero();
  c.matrix.solve(Eigen::Ref<VecX>(x));
  EXPECT_EQ(x.segment<6>(12).norm(), 0);
}

}  // namespace
}  // namespace sutura::thread
