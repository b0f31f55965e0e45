#include "corotational_t4.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "tissue_meshes.h"

namespace sutura {
namespace {

using test::kuhn_block;
using test::stacked;

struct Block {
  explicit Block(std::array<int, 3> cells = {2, 2, 2}, Real poisson = 0.3)
      : mesh(kuhn_block(cells, Vec3(1, 1, 1))),
        model(mesh.points, mesh.tets),
        A(static_cast<Index>(mesh.points.size()), model.pairs()),
        rest(stacked(mesh.points)) {
    model.bind(*A.pattern());
    model.set_materials(std::vector<Material>(mesh.tets.size(), Material{1e4, poisson, 1000}));
  }
  VecX force(const VecX& x) {
    VecX f = VecX::Zero(x.size());
    A.set_zero();
    model.linearise(x, 1, A, f);
    return f;
  }
  VecX turned(const Mat3& R) const {
    VecX x(rest.size());
    for (Index i = 0; i < rest.size(); i += 3) x.segment<3>(i) = R * rest.segment<3>(i);
    return x;
  }
  MatX dense() const {
    MatX K(rest.size(), rest.size());
    for (Index i = 0; i < A.nodes(); ++i)
      for (Index j = 0; j < A.nodes(); ++j) K.block<3, 3>(3 * i, 3 * j) = A.block(i, j);
    return K;
  }
  MeshData mesh;
  CorotationalT4 model;
  NodeMatrix A;
  VecX rest;
};

VecX noise(Index n, Real size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<Real> u(-size, size);
  VecX x(n);
  for (Index i = 0; i < n; ++i) x[i] = u(random);
  return x;
}

TEST(CorotationalT4, ForceIsMinusTheGradientOfTheEnergy) {
  Block block;
  const VecX x =
      block.rest + noise(block.rest.size(), 0.1, 1);  // strains of 40 %, some elements sheared hard
  const VecX f = block.force(x);
  const Real h = 1e-5;
  for (Index i = 0; i < x.size(); i += 7) {
    VecX up = x, down = x;
    up[i] += h;
    down[i] -= h;
    const Real slope = (block.model.energy(up) - block.model.energy(down)) / (2 * h);
    // Central differences: h^2 times the third derivative, and rounding of an energy of 1e3 J / h.
    EXPECT_NEAR(-f[i], slope, 1e-6 * f.cwiseAbs().maxCoeff());
  }
}

// K holds R while differentiating. At rest, however turned, that is the exact derivative of the
// force; away from it the part left out is of the order of the strain.
TEST(CorotationalT4, StiffnessIsTheDerivativeOfTheForceAtRestHoweverTurned) {
  Block block;
  const Mat3 R = Quat(0.3, -0.7, 0.2, 0.6).normalized().toRotationMatrix();
  const VecX x = block.turned(R);
  const VecX d = noise(x.size(), 1, 2);
  block.force(x);
  const MatX K = block.dense();
  const Real h = 1e-6;
  const VecX slope = (block.force(x + h * d) - block.force(x - h * d)) / (2 * h);
  EXPECT_LT((K * d + slope).norm(), 1e-8 * (K * d).norm());  // h^2 and rounding / h
}

TEST(CorotationalT4, WhatTheStiffnessLeavesOutShrinksWithTheStrain) {
  Block block;
  const VecX d = noise(block.rest.size(), 1, 3), shape = noise(block.rest.size(), 1, 4);
  const auto missing = [&](Real strain) {
    const VecX x = block.rest + strain * shape;
    block.force(x);
    const MatX K = block.dense();
    const Real h = 1e-7;
    const VecX slope = (block.force(x + h * d) - block.force(x - h * d)) / (2 * h);
    return (K * d + slope).norm() / (K * d).norm();
  };
  const Real at_1 = missing(0.01), at_2 = missing(0.02);
  EXPECT_LT(at_1, 0.05);             // of the order of a strain of 0.04
  EXPECT_NEAR(at_2 / at_1, 2, 0.1);  // first order
}

TEST(CorotationalT4, StiffnessIsSymmetricPositiveAndBlindToTranslation) {
  Block block;
  block.force(block.rest + noise(block.rest.size(), 0.3, 5));
  const MatX K = block.dense();
  EXPECT_EQ((K - K.transpose()).norm(), 0);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatX>(K).eigenvalues()[0], -1e-10 * K.norm());
  for (int axis = 0; axis < 3; ++axis) {
    VecX shift = VecX::Zero(K.rows());
    for (Index i = axis; i < shift.size(); i += 3) shift[i] = 1;
    EXPECT_LT((K * shift).norm(), 1e-12 * K.norm());
  }
}

TEST(CorotationalT4, InternalForcesAndMomentsBalance) {
  Block block;
  const VecX x = block.rest + noise(block.rest.size(), 0.2, 6);
  const VecX f = block.force(x);
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  for (Index i = 0; i < x.size(); i += 3) {
    sum += f.segment<3>(i);
    moment += x.segment<3>(i).cross(f.segment<3>(i));
  }
  EXPECT_LT(sum.norm(), 1e-11 * f.norm());
  EXPECT_LT(moment.norm(), 1e-10 * f.norm());  // symmetric stress: as good as the rotation
}

// A number of tets that is no multiple of the lanes, and tets in any order of nodes.
TEST(CorotationalT4, DoesNotDependOnOrderOrPacking) {
  Block block({1, 1, 1});
  const VecX x = block.rest + noise(block.rest.size(), 0.2, 7);
  const VecX f = block.force(x);
  MeshData other = block.mesh;
  std::reverse(other.tets.begin(), other.tets.end());
  for (Tet& t : other.tets) t = {t[1], t[2], t[0], t[3]};
  other.tets.push_back(other.tets[0]);  // one tet twice, the second without stiffness
  CorotationalT4 model(other.points, other.tets);
  NodeMatrix A(static_cast<Index>(other.points.size()), model.pairs());
  model.bind(*A.pattern());
  std::vector<Material> materials(other.tets.size(), Material{1e4, 0.3, 1000});
  materials.back().young = 0;
  model.set_materials(materials);
  VecX g = VecX::Zero(x.size());
  model.linearise(x, 1, A, g);
  EXPECT_LT((f - g).norm(), 1e-13 * f.norm());
  EXPECT_NEAR(model.energy(x), block.model.energy(x), 1e-13 * model.energy(x));
}

}  // namespace
}  // namespace sutura
