// Cases B1, B2, B6 and B7 of tests/reference: single elements and small patches.
#include <gtest/gtest.h>

#include "corotational_t4.h"
#include "csv.h"
#include "rotation.h"
#include "static_problem.h"

namespace sutura::tissue {
namespace {

using test::kuhn_block;
using test::StaticProblem;

/// The unit cube, two tets on every face around one interior node. The reference does not say which
/// diagonals its faces have; with these the largest force on a node is the tabulated one (the
/// energy does not care).
MeshData patch() {
  MeshData mesh;
  for (int i = 0; i < 8; ++i) mesh.points.push_back(Vec3(i & 1, (i >> 1) & 1, (i >> 2) & 1));
  mesh.points.push_back(Vec3(0.42, 0.57, 0.61));
  static constexpr Index faces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {1, 5, 4, 0},
                                        {3, 7, 6, 2}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& f : faces) {
    mesh.tets.push_back({f[0], f[1], f[2], 8});
    mesh.tets.push_back({f[0], f[2], f[3], 8});
  }
  return mesh;
}

Mat3 patch_gradient() {
  Mat3 H;
  H << 1, 0.5, 0.2, -0.3, -0.7, 0.4, 0.1, 0.25, 0.6;
  return 1e-3 * H;
}

TEST(ReferenceB1, PatchAloneAndTurned) {
  const testing::Table table = testing::reference("b01_patch.csv");
  const Mat3 F = Mat3::Identity() + patch_gradient();
  const Mat3 turns[] = {Mat3::Identity(),
                        Mat3(Eigen::AngleAxis<Real>(M_PI / 2, Vec3(1, 2, 3).normalized())),
                        Mat3(Eigen::AngleAxis<Real>(M_PI, Vec3::UnitZ()))};
  Real energy = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t row = k + 1;  // the first row is the linear element
    StaticProblem p(patch(), Material{1e4, 0.3, 1000});
    for (Index i = 0; i < p.nodes(); ++i) p.x.segment<3>(3 * i) = turns[k] * F * p.mesh().points[i];
    const VecX f = p.elastic_force();
    // The bound on the interior force is the reference's own (rounding); the rest of the table has
    // ten digits.
    const Real most = f.cwiseAbs().maxCoeff();
    EXPECT_LT(f.segment<3>(24).norm(), 1e-10 * most);
    EXPECT_NEAR(most, table.number(row, "max |f| N"), 1e-8);
    EXPECT_NEAR(p.model().energy(p.x), table.number(row, "energy J"), 5e-12);
    if (k == 0) energy = p.model().energy(p.x);
    EXPECT_NEAR(p.model().energy(p.x), energy, 1e-12 * energy);

    // Stress in the frame of the element, from the force on the faces: sum of x f^T / V is P in a
    // uniform field.
    Mat3 P = Mat3::Zero();
    for (Index i = 0; i < p.nodes(); ++i) P -= f.segment<3>(3 * i) * p.mesh().points[i].transpose();
    const Mat3 T = nearest_rotation(turns[k] * F).transpose() * P;
    const char* names[] = {"sxx", "sxy", "sxz", "syy", "syz", "szz"};
    const Real found[] = {T(0, 0), T(0, 1), T(0, 2), T(1, 1), T(1, 2), T(2, 2)};
    for (int c = 0; c < 6; ++c) EXPECT_NEAR(found[c], table.number(row, names[c]), 1e-7);
  }
}

/// Nominal stress P / E of a tet under a given F.
Mat3 nominal_stress(const Mat3& F, Real poisson) {
  MeshData mesh;
  mesh.points = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  mesh.tets = {{0, 1, 2, 3}};
  StaticProblem p(mesh, Material{1, poisson, 1});
  for (Index i = 0; i < 4; ++i) p.x.segment<3>(3 * i) = F * mesh.points[i];
  const VecX f = p.elastic_force();
  Mat3 P;
  for (int c = 0; c < 3; ++c)
    P.col(c) = -6 * f.segment<3>(3 * (c + 1));  // -V P grad N, V = 1/6, grad N = e_c
  return P;
}

TEST(ReferenceB2a, UniaxialStretch) {
  const testing::Table table = testing::reference("b02a_uniaxial.csv");
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const Real stretch = table.number(row, "stretch"),
               side = table.number(row, "lateral stretch corotational");
    const Mat3 P = nominal_stress(Vec3(stretch, side, side).asDiagonal(), 0.3);
    EXPECT_NEAR(P(0, 0), table.number(row, "nominal stress/E corotational"), 1e-10);
    EXPECT_NEAR(P(1, 1), 0, 1e-10);  // free lateral faces
  }
}

TEST(ReferenceB2b, SimpleShearTellsThePolarFrame) {
  const testing::Table table = testing::reference("b02b_simple_shear.csv");
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    Mat3 F = Mat3::Identity();
    F(0, 1) = table.number(row, "gamma");
    const Mat3 P = nominal_stress(F, 0.3);
    EXPECT_NEAR(P(0, 1), table.number(row, "P_xy/E corotational polar"),
                1e-9);  // ten digits in the table
    EXPECT_NEAR(P(0, 0), table.number(row, "P_xx/E"), 1e-9);
  }
}

TEST(ReferenceB6, PureRotationGivesNoForce) {
  const testing::Table table = testing::reference("b06_rotation.csv");
  const MeshData mesh = kuhn_block({3, 3, 3}, Vec3(1, 1, 1));
  const Real h = 1.0 / 3, E = 1e4;
  for (std::size_t row = 0; row < table.rows.size(); ++row)
    for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(1, 2, 3), Vec3(-0.1, 0.9, 0.4)}) {
      StaticProblem p(mesh, Material{E, 0.45, 1000});
      const Mat3 R(
          Eigen::AngleAxis<Real>(table.number(row, "angle deg") * M_PI / 180, axis.normalized()));
      for (Index i = 0; i < p.nodes(); ++i) p.x.segment<3>(3 * i) = R * mesh.points[i];
      EXPECT_LT(p.elastic_force().cwiseAbs().maxCoeff(), 1e-10 * E * h * h);
    }
}

TEST(ReferenceB7, InvertedTetIsPushedBack) {
  const testing::Table table = testing::reference("b07_inverted_tet.csv");
  MeshData mesh;
  mesh.points = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  mesh.tets = {{0, 1, 2, 3}};
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const Real t = table.number(row, "apex height t");
    StaticProblem p(mesh, Material{1, 0.3, 1});
    p.x[11] = t;
    const Real force = p.elastic_force()[11];
    // At t = -1 two singular values are equal and the rotation is not unique: only finiteness is
    // asked.
    if (t == -1) {
      EXPECT_TRUE(std::isfinite(force));
    } else {
      EXPECT_NEAR(force, table.number(row, "SVD polar, sign on smallest singular value"), 1e-9)
          << "t = " << t;
    }
    if (t > -1 && t < 1) {
      EXPECT_GT(force, 0) << "t = " << t;
    }
  }
  StaticProblem flat(mesh, Material{1, 0.3, 1});
  flat.x[11] = 0;
  EXPECT_TRUE(flat.elastic_force().allFinite());
  EXPECT_GT(flat.elastic_force()[11], 0);
}

}  // namespace
}  // namespace sutura::tissue
