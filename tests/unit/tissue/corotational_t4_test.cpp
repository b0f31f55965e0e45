#include "corotational_t4.h"

#include <gtest/gtest.h>

#include <random>

#include "tissue_meshes.h"

namespace sutura::tissue {
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
}  // namespace sutura::tissue
