#include "solid_queries.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tissue_meshes.h"

namespace sutura::tissue {
namespace {

using test::kuhn_block;
using test::stacked;

struct Solid {
  explicit Solid(MeshData data) : mesh(std::move(data)) {
    CheckedMesh checked = check_mesh(mesh, false);
    EXPECT_EQ(checked.error, "");
    x = stacked(mesh.points);
    queries = std::make_unique<SolidQueries>(
        std::make_shared<const SolidTopology>(mesh.points, mesh.tets, checked.boundary));
    queries->move(x);
  }
  MeshData mesh;
  VecX x;
  std::unique_ptr<SolidQueries> queries;
};

MeshData cube() {
  return kuhn_block({4, 4, 4}, Vec3(1, 1, 1));
}
/// The cube without the octant x, y, z > 1/2: it has concave edges and a concave corner.
MeshData notched() {
  MeshData mesh = cube();
  std::vector<Tet> kept;
  for (const Tet& t : mesh.tets) {
    Vec3 centre = Vec3::Zero();
    for (const Index i : t) centre += mesh.points[i] / 4;
    if ((centre.array() > 0.5).all()) continue;
    kept.push_back(t);
  }
  mesh.tets = kept;
  mesh.region.assign(kept.size(), 0);
  return mesh;
}

struct Uniform {
  std::mt19937 random{7};
  Vec3 operator()(Real low, Real high) {
    std::uniform_real_distribution<Real> u(low, high);
    const Real x = u(random), y = u(random), z = u(random);
    return {x, y, z};
  }
};
/// Signed distance to the box low..high.
Real box_distance(const Vec3& p, Real low, Real high) {
  const Vec3 q = (Vec3::Constant(low) - p).cwiseMax(p - Vec3::Constant(high));
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

TEST(SolidQueries, LocatesPointsAndPutsThemBack) {
  Solid s(cube());
  Uniform uniform;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = uniform(-0.2, 1.2);
    const auto found = s.queries->locate(p);
    EXPECT_EQ(found.has_value(), box_distance(p, 0, 1) < 0) << p.transpose();
    if (found) {
      EXPECT_LT((s.queries->position(*found) - p).norm(), 1e-14);
    }
  }
  for (const Vec3& corner : s.mesh.points)
    EXPECT_TRUE(s.queries->locate(corner));  // on faces, edges, corners
}

TEST(SolidQueries, SignedDistanceToACube) {
  Solid s(cube());
  Uniform uniform;
  for (int i = 0; i < 3000; ++i) {
    Vec3 p = uniform(-0.5, 1.5);
    if (i % 3 == 1) p[i % 2] = 1 + 1e-9;  // just off an edge or face
    if (i % 3 == 2) p = (p.array() > 0.5).select(Vec3::Constant(1.25), p);  // off corners and edges
    const auto found = s.queries->closest_surface(p, 3);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->distance, box_distance(p, 0, 1), 1e-14) << p.transpose();
    EXPECT_NEAR((p - found->position).norm(), std::abs(found->distance), 1e-14);
    EXPECT_NEAR(found->normal.norm(), 1, 1e-14);
    EXPECT_LT((s.queries->position(found->at) - found->position).norm(), 1e-14);
  }
  // Over a face the normal is the face's, also above an edge or node of the triangulation.
  for (const Real x : {0.25, 0.3, 0.5})
    EXPECT_LT((s.queries->closest_surface(Vec3(x, 0.25, 1.1), 1)->normal - Vec3::UnitZ()).norm(),
              1e-14);
  EXPECT_FALSE(s.queries->closest_surface(Vec3(0.5, 0.5, 2), 0.9));
}

// Beside an edge the top and the side of a block are as near, and rounding must not decide between
// them: the one that faces the way that is asked for is found, however the block stands.
TEST(SolidQueries, BesideAnEdgeTheTriangleThatFacesThatWayIsFound) {
  Uniform uniform;
  for (int k = 0; k < 200; ++k) {
    MeshData turned = cube();
    const Mat3 turn = Eigen::AngleAxisd(uniform(-3, 3).x(), uniform(-1, 1).normalized()).matrix();
    for (Vec3& p : turned.points) p = turn * p;
    Solid s(turned);
    const Vec3 up = turn * Vec3::UnitZ();
    const Vec3 beside = turn * Vec3(1 + 0.3 * uniform(0, 1).x(), uniform(0.1, 0.9).y(), 1);
    const auto found = s.queries->closest_surface(beside, 1, up);
    ASSERT_TRUE(found);
    EXPECT_GT(s.queries->surface_normal(found->triangle).dot(up), 0.999) << k;
  }
}

// Two cubes that touch, as the lips of a closed wound do: whoever says which side it means gets
// that one, although the other is as near.
TEST(SolidQueries, EachSideOfAClosedSlitIsFoundByItsNormal) {
  MeshData lips = cube();
  const MeshData other = cube();
  const auto nodes = static_cast<Index>(lips.points.size());
  for (const Vec3& p : other.points) lips.points.push_back(p + Vec3::UnitX());
  for (Tet t : other.tets) {
    for (Index& i : t) i += nodes;
    lips.tets.push_back(t);
    lips.region.push_back(1);
  }
  Solid s(lips);
  Uniform uniform;
  for (int i = 0; i < 200; ++i) {
    Vec3 p = uniform(0.3, 0.7);
    p.x() = 1 + 0.1 * (p.x() - 0.5);
    for (const Real side : {1., -1.}) {
      const Vec3 facing(side, 0.1, -0.2);
      const auto near = s.queries->closest_surface(p, 1, facing);
      ASSERT_TRUE(near);
      EXPECT_NEAR(near->position.x(), 1, 1e-14);
      EXPECT_NEAR(near->normal.x(), side, 1e-14);
      EXPECT_NEAR(near->distance, side * (p.x() - 1), 1e-14);
      const auto crossed = s.queries->crossing(p - 0.3 * facing, p + 0.3 * facing, facing);
      ASSERT_TRUE(crossed);
      EXPECT_NEAR(crossed->position.x(), 1, 1e-14);
      EXPECT_NEAR(crossed->normal.x(), side, 1e-14);
    }
  }
}

// The sign near concave edges: outside is where no tet is.
TEST(SolidQueries, SignIsRightAtConcaveEdgesAndCorners) {
  Solid s(notched());
  Uniform uniform;
  int outside = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 p = uniform(0.3, 0.7);
    const auto found = s.queries->closest_surface(p, 3);
    ASSERT_TRUE(found);
    const bool in_notch = (p.array() > 0.5).all();
    EXPECT_EQ(found->distance > 0, in_notch) << p.transpose();
    outside += in_notch;
  }
  EXPECT_GT(outside, 300);
}

TEST(SolidQueries, SegmentsCrossWhereTheyEnter) {
  Solid s(cube());
  Uniform uniform;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 a = uniform(-1, 2), b = uniform(-1, 2);
    // The slab method, independent of any triangle.
    Real enter = 0, leave = 1;
    bool starts_inside = box_distance(a, 0, 1) < 0;
    for (int k = 0; k < 3; ++k) {
      const Real d = b[k] - a[k], t0 = (0 - a[k]) / d, t1 = (1 - a[k]) / d;
      enter = std::max(enter, std::min(t0, t1));
      leave = std::min(leave, std::max(t0, t1));
    }
    const bool crosses = starts_inside ? leave < 1 : enter < leave;
    const Real at = starts_inside ? leave : enter;
    const auto found = s.queries->crossing(a, b);
    ASSERT_EQ(found.has_value(), crosses) << a.transpose() << " to " << b.transpose();
    if (!crosses) continue;
    EXPECT_LT((found->position - (a + at * (b - a))).norm(), 1e-12);
    EXPECT_EQ(found->distance > 0, !starts_inside);
    EXPECT_NEAR(found->distance, (a - found->position).dot(found->normal), 1e-14);
  }
}

// No leak: segments aimed at nodes and edge midpoints of the boundary of a bent block.
TEST(SolidQueries, NoSegmentSlipsThroughAnEdgeOrNode) {
  Solid s(cube());
  Uniform uniform;
  for (Index i = 0; i < s.x.size(); i += 3) {
    const Vec3 X = s.x.segment<3>(i);
    s.x.segment<3>(i) =
        Vec3(X[0] + 0.1 * std::sin(3 * X[2]), X[1] + 0.05 * X[0] * X[2], X[2] + 0.07 * X[1] * X[1]);
  }
  s.queries->move(s.x);
  const Vec3 inside(0.6, 0.5, 0.5);
  ASSERT_TRUE(s.queries->locate(inside));
  for (Index i = 0; i < static_cast<Index>(s.mesh.points.size()); ++i)
    for (Index j = 0; j <= i; j += 3) {
      const Vec3 through = 0.5 * (s.x.segment<3>(3 * i) + s.x.segment<3>(3 * j));
      const Vec3 outside = inside + 50 * (through - inside);
      if ((outside - inside).norm() < 5) continue;
      EXPECT_TRUE(s.queries->crossing(inside, outside)) << i << " " << j;
      EXPECT_TRUE(s.queries->crossing(outside, inside)) << i << " " << j;
    }
}

TEST(SolidQueries, AnswersDoNotDependOnTheOrderOfTets) {
  Solid s(cube());
  MeshData shuffled = cube();
  std::shuffle(shuffled.tets.begin(), shuffled.tets.end(), std::mt19937(3));
  Solid other(std::move(shuffled));
  Uniform uniform;
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = uniform(-0.3, 1.3);
    const auto a = s.queries->closest_surface(p, 3), b = other.queries->closest_surface(p, 3);
    EXPECT_EQ(a->position, b->position);
    EXPECT_EQ(a->distance, b->distance);
    EXPECT_LT((a->normal - b->normal).norm(), 1e-15);  // a sum over triangles in another order
  }
}

}  // namespace
}  // namespace sutura::tissue
