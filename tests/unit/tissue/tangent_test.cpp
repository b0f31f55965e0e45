// The stiffness of both element families against differences of their force, and the force against
// itself.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <memory>
#include <random>

#include "corotational_t4.h"
#include "smoothed_t4.h"
#include "tissue_meshes.h"

namespace sutura::tissue {
namespace {

using test::kuhn_block;
using test::stacked;

using Make = std::unique_ptr<ElasticModel> (*)(const MeshData&);
std::unique_ptr<ElasticModel> t4(const MeshData& m) {
  return std::make_unique<CorotationalT4>(m.points, m.tets);
}
std::unique_ptr<ElasticModel> smoothed(const MeshData& m) {
  return std::make_unique<SmoothedT4>(m.points, m.tets);
}

struct Family {
  const char* name;
  Make make;
  Real poisson;
};

class Tangent : public ::testing::TestWithParam<Family> {
 protected:
  VecX force(const VecX& x) {
    VecX f = VecX::Zero(x.size());
    A.set_zero();
    model->linearise(x, 1, A, f);
    return f;
  }
  MatX stiffness(const VecX& x) {
    force(x);
    MatX K(x.size(), x.size());
    for (Index i = 0; i < A.nodes(); ++i)
      for (Index j = 0; j < A.nodes(); ++j) K.block<3, 3>(3 * i, 3 * j) = A.block(i, j);
    return K;
  }
  /// -df/dx by central differences: h^2 times the third derivative, and rounding over h.
  MatX slope(const VecX& x) {
    constexpr Real h = 1e-6;
    MatX K(x.size(), x.size());
    VecX at = x;
    for (Index i = 0; i < x.size(); ++i) {
      at[i] = x[i] + h;
      K.col(i) = -force(at);
      at[i] = x[i] - h;
      K.col(i) += force(at);
      K.col(i) /= 2 * h;
      at[i] = x[i];
    }
    return K;
  }
  VecX mapped(const Mat3& F) const {
    VecX x(rest.size());
    for (Index i = 0; i < x.size(); i += 3) x.segment<3>(i) = F * rest.segment<3>(i);
    return x;
  }
  VecX noise(Real size, unsigned seed) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<Real> u(-size, size);
    VecX x(rest.size());
    for (Real& v : x) v = u(random);
    return x;
  }

  MeshData mesh = kuhn_block({2, 2, 2}, Vec3(1, 1, 1));
  std::unique_ptr<ElasticModel> model = GetParam().make(mesh);
  NodeMatrix A{static_cast<Index>(mesh.points.size()), model->pairs()};
  VecX rest = stacked(mesh.points);

  Tangent() {
    model->bind(*A.pattern());
    model->set_materials(
        std::vector<Material>(mesh.tets.size(), Material{1e4, GetParam().poisson, 1000}));
  }
};

const Mat3 turned = Quat(0.3, -0.7, 0.2, 0.6).normalized().toRotationMatrix();
constexpr Real difference = 1e-8;

TEST_P(Tangent, IsExactAtRestHoweverTurned) {
  const MatX K = stiffness(mapped(turned)), expected = slope(mapped(turned));
  EXPECT_LT((K - expected).norm(), difference * K.norm());
}

// Swollen: every part of either family is stretched.
TEST_P(Tangent, IsExactWhereEverythingSwells) {
  for (const Real stretch : {1.01, 1.2, 2.0}) {
    const VecX x = mapped(stretch * turned);
    const MatX K = stiffness(x), expected = slope(x);
    EXPECT_LT((K - expected).norm(), difference * K.norm()) << stretch;
  }
}

// Anywhere else the parts that would push the matrix below zero are left out, and nothing more:
// what K has beyond the exact derivative is never negative.
TEST_P(Tangent, LeavesOutNothingButNegativeParts) {
  for (const Real size : {0.01, 0.1, 0.3}) {
    const VecX x = mapped(turned) + noise(size, 3);
    const MatX K = stiffness(x), beyond = K - slope(x);
    const MatX symmetric = 0.5 * (beyond + beyond.transpose());
    const Eigen::SelfAdjointEigenSolver<MatX> eigen(symmetric);
    EXPECT_GT(eigen.eigenvalues()[0], -10 * difference * K.norm()) << size;
    EXPECT_GT(eigen.eigenvalues().reverse()[0], 1e-4 * K.norm()) << size;  // there was something
  }
}

TEST_P(Tangent, IsSymmetricPositiveAndBlindToTranslation) {
  for (const Real size : {0.0, 0.1, 0.3, 1.0}) {
    const MatX K = stiffness(rest + noise(size, 5));
    EXPECT_EQ((K - K.transpose()).norm(), 0);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatX>(K).eigenvalues()[0], -1e-10 * K.norm()) << size;
    for (int axis = 0; axis < 3; ++axis) {
      VecX shift = VecX::Zero(K.rows());
      for (Index i = axis; i < shift.size(); i += 3) shift[i] = 1;
      EXPECT_LT((K * shift).norm(), 1e-12 * K.norm()) << size;
    }
  }
}

// A rigid motion, however far it turns, adds no force to that of the strain it starts with.
TEST_P(Tangent, ViscosityLeavesARigidMotionAlone) {
  const VecX start = rest + noise(0.1, 11);
  VecX elastic = VecX::Zero(start.size()), viscous = elastic, moved(start.size());
  for (Index i = 0; i < start.size(); i += 3)
    moved.segment<3>(i) = turned * start.segment<3>(i) + Vec3(0.1, -0.2, 0.3);
  model->add_force(moved, elastic);
  model->set_viscosity(start, 0.9);
  model->add_force(moved, viscous);
  EXPECT_LT((viscous - elastic).norm(), 1e-11 * elastic.norm());  // rounding, times 1/(1 - share)
}

// From rest, strain and its rate are one: beta/h times as much comes on top, in force and tangent.
TEST_P(Tangent, ViscosityFromRestIsAsMuchStiffnessMore) {
  constexpr Real h = 0.01, beta = 0.03;
  const VecX x = rest + noise(0.05, 13);
  const VecX elastic = force(x);
  const MatX K = stiffness(x);
  model->set_viscosity(rest, beta / (h + beta));
  EXPECT_LT((force(x) - (1 + beta / h) * elastic).norm(), 1e-12 * (1 + beta / h) * elastic.norm());
  EXPECT_LT((stiffness(x) - K).norm(), 1e-12 * K.norm());
}

// The balance of a step is measured with the one and linearised with the other.
TEST_P(Tangent, ForceAloneIsThatOfTheLinearisationToTheBit) {
  for (const Real size : {0.0, 0.1, 1.0}) {
    const VecX x = mapped(turned) + noise(size, 7);
    VecX alone = VecX::Zero(x.size());
    model->add_force(x, alone);
    EXPECT_EQ(alone, force(x)) << size;
  }
}

INSTANTIATE_TEST_SUITE_P(Families, Tangent,
                         ::testing::Values(Family{"t4_nu30", &t4, 0.3},
                                           Family{"t4_nu49", &t4, 0.49},
                                           Family{"smoothed_nu30", &smoothed, 0.3},
                                           Family{"smoothed_nu45", &smoothed, 0.45}),
                         [](const auto& i) { return i.param.name; });

/// Linear tets alone: of them every state in which all principal stretches are above one is exact.
class TangentOfT4 : public Tangent {};

TEST_P(TangentOfT4, IsExactWhereNothingIsCompressed) {
  // Unequal stretches in axes of their own; the noise is small against the smallest of them.
  const Mat3 axes(Eigen::AngleAxis<Real>(0.7, Vec3(1, 2, -1).normalized()));
  const Mat3 F = turned * axes * Vec3(1.2, 1.5, 1.9).asDiagonal() * axes.transpose();
  const VecX x = mapped(F) + noise(0.02, 9);
  const MatX K = stiffness(x), expected = slope(x);
  EXPECT_LT((K - expected).norm(), difference * K.norm());
}

INSTANTIATE_TEST_SUITE_P(Families, TangentOfT4,
                         ::testing::Values(Family{"nu0", &t4, 0.0}, Family{"nu30", &t4, 0.3},
                                           Family{"nu49", &t4, 0.49}),
                         [](const auto& i) { return i.param.name; });

}  // namespace
}  // namespace sutura::tissue
