#include "cut_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mesh_check.h"
#include "tissue_meshes.h"

namespace sutura::tissue {
namespace {

using test::kuhn_block;

/// Opens what lies in the plane of an axis at 1/2, as far as `within` says so of a corner.
template <class Within>
Index cut_half_way(MeshData& mesh, Index axis, const Within& within) {
  return cut_open(mesh, [&](const std::array<Vec3, 3>& face) {
    return std::all_of(face.begin(), face.end(),
                       [&](const Vec3& p) { return std::abs(p[axis] - 0.5) < 1e-9 && within(p); });
  });
}
const auto everywhere = [](const Vec3&) { return true; };

Real boundary_area(const MeshData& mesh, const CheckedMesh& checked) {
  Real area = 0;
  for (const BoundaryFace& f : checked.boundary) {
    const Vec3 a = mesh.points[f.nodes[0]], b = mesh.points[f.nodes[1]],
               c = mesh.points[f.nodes[2]];
    area += (b - a).cross(c - a).norm() / 2;
  }
  return area;
}

// A cube of 4 x 4 x 4 cells, cut from above to half its depth: 4 x 2 squares of two triangles. Of
// the 5 x 3 nodes in it all are there twice but the 5 at its end.
TEST(CutMesh, NodesAreTwiceButWhereTheCutEnds) {
  MeshData mesh = kuhn_block({4, 4, 4}, Vec3(1, 1, 1));
  const std::size_t before = mesh.points.size();
  const Index faces = cut_half_way(mesh, 0, [](const Vec3& p) { return p.z() > 0.5 - 1e-9; });
  EXPECT_EQ(faces, 16);
  EXPECT_EQ(mesh.points.size(), before + 10);
  EXPECT_EQ(mesh.copied_nodes, 10);
  const CheckedMesh checked = check_mesh(mesh, false);
  EXPECT_EQ(checked.error, "");
  EXPECT_TRUE(checked.report.warnings.empty());
  EXPECT_EQ(checked.report.parts, 1);
  EXPECT_NEAR(boundary_area(mesh, checked), 6 + 2 * 0.5, 1e-12);
}

// One that ends nowhere makes two blocks of it, whose nodes are no others' any more.
TEST(CutMesh, RightThroughMakesTwoParts) {
  MeshData mesh = kuhn_block({4, 4, 4}, Vec3(1, 1, 1));
  EXPECT_EQ(cut_half_way(mesh, 1, everywhere), 32);
  EXPECT_EQ(mesh.copied_nodes, 25);
  const CheckedMesh checked = check_mesh(mesh, false);
  EXPECT_EQ(checked.error, "");
  EXPECT_EQ(checked.report.parts, 2);
  EXPECT_NEAR(boundary_area(mesh, checked), 6 + 2, 1e-12);
}

// Where two cross, a node comes apart into four; where three do, into eight.
TEST(CutMesh, CutsMayCross) {
  MeshData mesh = kuhn_block({4, 4, 4}, Vec3(1, 1, 1));
  for (const Index axis : {0, 1, 2}) cut_half_way(mesh, axis, everywhere);
  const auto at_middle = std::count_if(mesh.points.begin(), mesh.points.end(), [](const Vec3& p) {
    return (p - Vec3(0.5, 0.5, 0.5)).norm() < 1e-9;
  });
  EXPECT_EQ(at_middle, 8);
  const CheckedMesh checked = check_mesh(mesh, false);
  EXPECT_EQ(checked.error, "");
  EXPECT_EQ(checked.report.parts, 8);
  EXPECT_NEAR(boundary_area(mesh, checked), 8 * 6 * 0.25, 1e-12);
}

TEST(CutMesh, AFaceOfTheBoundaryIsNotCut) {
  MeshData mesh = kuhn_block({2, 2, 2}, Vec3(1, 1, 1));
  EXPECT_EQ(cut_open(mesh,
                     [](const std::array<Vec3, 3>& face) {
                       return std::all_of(face.begin(), face.end(),
                                          [](const Vec3& p) { return p.z() == 0; });
                     }),
            0);
  EXPECT_EQ(mesh.copied_nodes, 0);
}

}  // namespace
}  // namespace sutura::tissue
