// The boundary of a tissue as triangles, as contact and viewers see it.
#include "sutura/geometry/triangle_surface.h"

#include <gtest/gtest.h>

#include <vector>

#include "near_triangles.h"
#include "tissue_scene.h"

namespace sutura::tissue {
namespace {

const std::string block =
    "<TetMesh file='tests/unit/tissue/meshes/msh22_ascii.msh' unit='cm'/>"  // 2 x 1 x 2 cm
    "<Tissue young='5 kPa'/><Attach box='0 0 2  2 1 2 cm'/>";

/// By the divergence theorem (m^3): right only if all triangles are there and face outward.
Real enclosed_volume(const TriangleSurface& surface) {
  Real six = 0;
  for (Index i = 0; i < surface.size(); ++i)
    six += surface.corners(i)[0].dot(surface.area_normal(i));
  return six / 6;
}

TEST(TriangleSurface, EnclosesTheSolid) {
  test::TissueScene s(block);
  const MeshedSolid& solid = s.tissue();
  const TriangleSurface rest = solid.surface(Configuration::rest);
  EXPECT_NEAR(enclosed_volume(rest), 4e-6, 1e-18);
  Vec3 sum = Vec3::Zero();
  for (Index i = 0; i < rest.size(); ++i) sum += rest.area_normal(i);
  EXPECT_LT(sum.norm(), 1e-18);  // closed
}

TEST(TriangleSurface, WithATreeItFindsWhatASegmentComesNear) {
  test::TissueScene s(block);
  const MeshedSolid& solid = s.tissue();
  test::NearTriangles near(solid);
  const Real reach = 2e-3;
  int met = 0;
  for (int step = 0; step < 20; ++step) {
    s.step();
    const TriangleSurface now = solid.surface(Configuration::current);
    const Segment segment{Vec3(-5e-3 + 1e-3 * step, 4e-3, 3e-3), Vec3(12e-3, 6e-3, -2e-3)};
    std::vector<char> found(static_cast<std::size_t>(now.size()), 0);
    near.visit(segment, reach, [&](Index i, const SegmentTriangle&) { found[i] = 1; });
    for (Index i = 0; i < now.size(); ++i) {
      const bool is_near =
          closest_points(segment, now.corners(i)).squared_distance <= reach * reach;
      EXPECT_EQ(found[i] != 0, is_near);
      met += is_near;
    }
  }
  EXPECT_GT(met, 20);
}

TEST(TriangleSurface, FollowsEachConfiguration) {
  test::TissueScene s(block);
  const MeshedSolid& solid = s.tissue();
  const auto count = [&](Configuration c) { return solid.surface(c).generation; };
  const auto rest = count(Configuration::rest), start = count(Configuration::start),
             current = count(Configuration::current);
  const VecX before = s.tissue().positions();
  s.step();
  EXPECT_EQ(count(Configuration::rest), rest);
  EXPECT_NE(count(Configuration::start), start);
  EXPECT_NE(count(Configuration::current), current);
  const TriangleSurface was = solid.surface(Configuration::start),
                        now = solid.surface(Configuration::current);
  EXPECT_EQ(was.triangles.data(), now.triangles.data());
  for (Index node = 0; node < before.size() / 3; ++node) {
    EXPECT_EQ(was.point(node), before.segment<3>(3 * node));
    EXPECT_EQ(now.point(node), s.tissue().positions().segment<3>(3 * node));
  }
  EXPECT_GT((s.tissue().positions() - before).norm(), 0);
}

TEST(TriangleSurface, APointOfATriangleIsAPointOfTheSolid) {
  test::TissueScene s(block);
  for (int i = 0; i < 10; ++i) s.step();
  const MeshedSolid& solid = s.tissue();
  const TriangleSurface now = solid.surface(Configuration::current);
  const Vec3 weights(0.5, 0.3, 0.2);
  for (Index i = 0; i < now.size(); ++i) {
    const std::array<Vec3, 3> t = now.corners(i);
    const Vec3 expected = weights[0] * t[0] + weights[1] * t[1] + weights[2] * t[2];
    const Vec3 found = solid.position(solid.on_surface(i, weights), Configuration::current);
    EXPECT_LT((found - expected).norm(), 1e-16);  // rounding of 2 cm
  }
}

}  // namespace
}  // namespace sutura::tissue
