// What simulations of the same mesh share: the checked mesh and the plan of elimination.
#include "rest_shape.h"

#include <gtest/gtest.h>

#include "factor.h"
#include "sutura/cache.h"
#include "tissue_meshes.h"

namespace sutura::tissue {
namespace {

MeshData grid() {
  return test::kuhn_block({3, 2, 2}, Vec3(0.03, 0.02, 0.02));
}

TEST(RestShape, IsSharedByMeshesOfTheSameBits) {
  Cache cache;
  const auto first = rest_shape(grid(), false, &cache);
  EXPECT_EQ(rest_shape(grid(), false, &cache), first);
  EXPECT_NE(rest_shape(grid(), true, &cache), first);
  EXPECT_NE(rest_shape(grid(), false, nullptr), first);

  // Each part of a mesh counts, to the bit: -0 is not 0.
  MeshData other = grid();
  for (Vec3& p : other.points)
    if (p.x() == 0) p.x() = -0.0;
  EXPECT_NE(rest_shape(other, false, &cache), first);
  other = grid();
  std::swap(other.tets[0], other.tets[1]);
  EXPECT_NE(rest_shape(other, false, &cache), first);
  other = grid();
  other.region[0] = 1;
  EXPECT_NE(rest_shape(other, false, &cache), first);
  other = grid();
  other.region_names[0] = "skin";
  EXPECT_NE(rest_shape(other, false, &cache), first);
}

TEST(RestShape, AMeshThatCannotBeUsedIsToldSoEachTime) {
  Cache cache;
  MeshData flat = grid();
  for (Vec3& p : flat.points) p.z() = 0;
  const auto first = rest_shape(flat, false, &cache);
  EXPECT_NE(first->checked.error, "");
  EXPECT_EQ(first->topology, nullptr);
  EXPECT_EQ(rest_shape(flat, false, &cache)->checked.error, first->checked.error);
}

TEST(FactorPlan, IsSharedByTissuesThatAreHeldAlike) {
  Cache cache;
  const MeshData mesh = grid();
  std::vector<Index> nodes;
  for (const Tet& t : mesh.tets) nodes.insert(nodes.end(), t.begin(), t.end());
  const auto pattern = std::make_shared<const NodePattern>(static_cast<Index>(mesh.points.size()),
                                                           pairs_of_elements(nodes, 4));
  std::vector<char> fixed(mesh.points.size(), 0);
  fixed[0] = 1;
  const std::vector<Index> none, some{5, 6};
  const auto plan = [&](const std::vector<Index>& last) {
    return make_factor_plan(pattern, fixed, last, default_backend(), &cache);
  };
  const auto first = plan(none);
  EXPECT_EQ(plan(none), first);
  EXPECT_NE(plan(some), first);
  fixed[1] = 1;
  EXPECT_NE(plan(none), first);
}

}  // namespace
}  // namespace sutura::tissue
