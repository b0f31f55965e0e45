// The element that does not lock: consistency, and the cases of tests/reference that T4 fails.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "../../validation/tissue/static_problem.h"
#include "csv.h"
#include "rotation.h"
#include "smoothed_t4.h"

namespace sutura::tissue {
namespace {

using test::kuhn_block;
using test::StaticProblem;

std::unique_ptr<ElasticModel> smoothed(const MeshData& mesh) {
  return std::make_unique<SmoothedT4>(mesh.points, mesh.tets);
}

/// A block whose inner nodes are displaced by up to a fifth of a cell, by a rule of their own.
MeshData jittered(std::array<int, 3> cells, const Vec3& size) {
  MeshData mesh = kuhn_block(cells, size);
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const Real x = mesh.points[i][c], cell = size[c] / cells[static_cast<std::size_t>(c)];
      if (x < cell / 2 || x > size[c] - cell / 2) continue;
      mesh.points[i][c] += 0.2 * cell * std::sin(12.9898 * Real(i) + 78.233 * c);
    }
  return mesh;
}

TEST(SmoothedT4, UniformStrainIsExact) {
  const MeshData mesh = jittered({3, 3, 3}, Vec3(1, 1, 1));
  Mat3 H;
  H << 1, 0.5, 0.2, -0.3, -0.7, 0.4, 0.1, 0.25, 0.6;
  const Mat3 F = Mat3::Identity() + 0.1 * H;
  const Material material{1e4, 0.4, 1000};
  for (const Real angle : {0.0, 1.5, std::numbers::pi}) {
    const Mat3 turn(Eigen::AngleAxis<Real>(angle, Vec3(1, 2, 3).normalized()));
    StaticProblem plain(mesh, material), cured(mesh, material, smoothed(mesh));
    for (Index i = 0; i < plain.nodes(); ++i)
      plain.x.segment<3>(3 * i) = turn * F * mesh.points[std::size_t(i)];
    cured.x = plain.x;
    // Every average of one F is that F: energy and forces are those of the plain element, which are
    // tested against B1.
    const Real energy = plain.model().energy(plain.x);
    EXPECT_NEAR(cured.model().energy(cured.x), energy, 1e-12 * energy);
    const VecX f = plain.elastic_force();
    EXPECT_LT((cured.elastic_force() - f).norm(), 1e-11 * f.norm());
  }
}

TEST(SmoothedT4, ForceIsMinusTheGradientOfTheEnergy) {
  const MeshData mesh = jittered({2, 2, 2}, Vec3(1, 1, 1));
  StaticProblem p(mesh, Material{10, 0.45, 1}, smoothed(mesh));
  for (Index i = 0; i < p.x.size(); ++i) p.x[i] += 0.05 * std::sin(7.0 * Real(i));
  const VecX f = p.elastic_force();
  const Real step = 1e-5;
  for (Index i = 0; i < p.x.size(); i += 5) {
    const Real at = p.x[i];
    p.x[i] = at + step;
    const Real up = p.model().energy(p.x);
    p.x[i] = at - step;
    const Real down = p.model().energy(p.x);
    p.x[i] = at;
    // Central differences: error of order step^2 times the third derivative (some 10 / 0.5^2).
    EXPECT_NEAR(f[i], -(up - down) / (2 * step), 1e-7 * f.norm());
  }
}

TEST(SmoothedT4, RotationsCostNoForce) {
  const MeshData mesh = jittered({2, 3, 2}, Vec3(0.02, 0.03, 0.02));
  StaticProblem p(mesh, Material{1e4, 0.49, 1000}, smoothed(mesh));
  for (int degrees = 0; degrees <= 360; degrees += 30) {
    const Mat3 R(
        Eigen::AngleAxis<Real>(degrees * std::numbers::pi / 180, Vec3(3, -1, 2).normalized()));
    for (Index i = 0; i < p.nodes(); ++i) p.x.segment<3>(3 * i) = R * mesh.points[std::size_t(i)];
    EXPECT_LT(p.elastic_force().cwiseAbs().maxCoeff(), 1e-10 * 1e4 * 0.01 * 0.01) << degrees;
  }
}

TEST(SmoothedT4, LayersDoNotSmearIntoEachOther) {
  // Two layers in series, pulled apart without lateral strain (nu = 0): each strains by the common
  // stress over its own modulus.
  MeshData mesh = kuhn_block({2, 2, 4}, Vec3(1, 1, 2));
  auto model = smoothed(mesh);
  ElasticModel& m = *model;
  StaticProblem p(mesh, Material{100, 0, 1}, std::move(model));
  std::vector<Material> materials;
  for (const Tet& t : mesh.tets) {
    Real z = 0;
    for (const Index i : t) z += mesh.points[std::size_t(i)].z() / 4;
    materials.push_back({z < 1 ? 100.0 : 10000.0, 0, 1});
  }
  m.set_materials(materials);
  // u(1) = 0.01, u(2) - u(1) = 1e-4: exact for tets.
  for (Index i = 0; i < p.nodes(); ++i) {
    const Real z = mesh.points[std::size_t(i)].z();
    p.x[3 * i + 2] += z <= 1 ? 0.01 * z : 0.01 + 1e-4 * (z - 1);
  }
  const VecX f = p.elastic_force();
  for (Index i = 0; i < p.nodes(); ++i) {
    const Real z = mesh.points[std::size_t(i)].z();
    if (z > 0.1 && z < 1.9) {
      EXPECT_LT(f.segment<3>(3 * i).norm(), 1e-12);
    }
  }
}

/// Mean deflection of the end face of case B3 over the reference, minus one.
Real bending_error(Real poisson, const MeshData& mesh, std::unique_ptr<ElasticModel> model) {
  StaticProblem p(mesh, Material{1e4, poisson, 1000}, std::move(model));
  p.fix([](const Vec3& X) { return X.x() < 1e-9; });
  // The load is spread over the end face like a traction: a third of a triangle to each corner.
  Real area = 0;
  for (const Tet& t : mesh.tets)
    for (int skip = 0; skip < 4; ++skip) {
      std::array<Index, 3> f{};
      int k = 0;
      for (int c = 0; c < 4; ++c)
        if (c != skip) f[std::size_t(k++)] = t[std::size_t(c)];
      bool on_end = true;
      for (const Index i : f) on_end = on_end && mesh.points[std::size_t(i)].x() > 0.1 - 1e-9;
      if (!on_end) continue;
      const auto& q = mesh.points;
      const Real a = 0.5 * (q[f[1]] - q[f[0]]).cross(q[f[2]] - q[f[0]]).norm();
      area += a;
      for (const Index i : f) p.load[3 * i + 2] -= 1e-4 * a / (0.02 * 0.02) / 3;
    }
  EXPECT_NEAR(area, 4e-4, 1e-12);
  EXPECT_LT(p.newton(1), 1);
  Real sum = 0;
  for (Index i = 0; i < p.nodes(); ++i)
    sum -= p.load[3 * i + 2] * (p.x[3 * i + 2] - mesh.points[std::size_t(i)].z());
  const testing::Table table = testing::reference("b03_cantilever_small.csv");
  for (std::size_t row = 0; row < table.rows.size(); ++row)
    if (table.number(row, "nu") == poisson && table.text(row, "element").starts_with("reference"))
      return -sum / 1e-4 / table.number(row, "mean end deflection m") - 1;
  ADD_FAILURE() << "no reference";
  return 1;
}

TEST(SmoothedT4, BendsRightWithFourElementsAcross) {
  const MeshData mesh = kuhn_block({20, 4, 4}, Vec3(0.1, 0.02, 0.02));
  const MeshData rough = jittered({20, 4, 4}, Vec3(0.1, 0.02, 0.02));
  for (const Real poisson : {0.3, 0.45, 0.49}) {
    const Real error = bending_error(poisson, mesh, smoothed(mesh));
    const Real jitter = bending_error(poisson, rough, smoothed(rough));
    const Real plain =
        bending_error(poisson, mesh, std::make_unique<CorotationalT4>(mesh.points, mesh.tets));
    std::printf("bending, nu %.2f: T4 %+.1f %%, smoothed %+.2f %%, jittered %+.2f %%\n", poisson,
                100 * plain, 100 * error, 100 * jitter);
    // The bar of the project: 5 %; T4 misses by 20 to 60 %.
    EXPECT_LT(std::abs(error), 0.05);
    EXPECT_LT(std::abs(jitter), 0.05);
  }
}

TEST(SmoothedT4, BendingConverges) {
  Real error[2];
  int k = 0;
  for (const int n : {2, 4}) {
    const MeshData mesh = kuhn_block({5 * n, n, n}, Vec3(0.1, 0.02, 0.02));
    error[k++] = std::abs(bending_error(0.45, mesh, smoothed(mesh)));
  }
  // Order one at least: a corner singularity of the clamped face and the change of sign of the
  // error keep it from being measured more sharply than this.
  EXPECT_LT(error[1], 0.5 * error[0]);
}

}  // namespace
}  // namespace sutura::tissue
