// Nodes on the convex edges of a closed surface, which stays what it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "split_edges.h"

namespace sutura::contact {
namespace {

constexpr Real longest = 0.7;

/// A gutter of 10 x 30: a block whose top falls towards x = 0, where its edge is hollow.
TriangleData gutter() {
  TriangleData out;
  for (const Real y : {-15., 15.})
    for (const Vec3& p :
         {Vec3(0, y, 0), Vec3(-5, y, 2), Vec3(-5, y, -3), Vec3(5, y, -3), Vec3(5, y, 2)})
      out.points.push_back(p);
  out.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {7, 6, 5}, {8, 7, 5}, {9, 8, 5}};
  for (Index k = 0; k < 5; ++k) {
    const Index next = (k + 1) % 5;
    out.triangles.push_back({k, k + 5, next + 5});
    out.triangles.push_back({k, next + 5, next});
  }
  return out;
}

Real length(const TriangleData& s, Index a, Index b) {
  return (s.points[static_cast<std::size_t>(a)] - s.points[static_cast<std::size_t>(b)]).norm();
}

TEST(SplitEdges, LeavesTheSurfaceWhereItIs) {
  const TriangleData before = gutter(), after = split_convex_edges(before, longest);
  std::string error;
  const auto expected = TriangleMesh::close(before, error),
             found = TriangleMesh::close(after, error);
  ASSERT_TRUE(expected && found) << error;
  for (const Vec3& p : after.points) EXPECT_NEAR(expected->signed_distance(p), 0, 1e-12);
  // Points around it are as far from both.
  for (const Vec3& p : {Vec3(0.3, 1, 2), Vec3(-4, 16, 1), Vec3(2, -3, -1), Vec3(7, 20, 5)})
    EXPECT_NEAR(found->signed_distance(p), expected->signed_distance(p), 1e-12);
}

// The edges of the block are long and convex; the bottom of the gutter is not, nor are diagonals.
TEST(SplitEdges, HalvesWhatIsConvexAndLong) {
  const TriangleData after = split_convex_edges(gutter(), longest);
  const auto on_edge = [&](Real x, Real z) {
    std::vector<Real> places;
    for (const Vec3& p : after.points)
      if (p.x() == x && p.z() == z) places.push_back(p.y());
    std::sort(places.begin(), places.end());
    Real widest = 0;
    for (std::size_t i = 1; i < places.size(); ++i)
      widest = std::max(widest, places[i] - places[i - 1]);
    return widest;
  };
  for (const auto& [x, z] : {std::pair{-5., 2.}, {-5., -3.}, {5., -3.}, {5., 2.}})
    EXPECT_LE(on_edge(x, z), longest) << x << ' ' << z;
  EXPECT_GT(on_edge(0, 0), longest);
}

// Of the longest edges and the shortest ones of a triangle the ratio stays what it was.
TEST(SplitEdges, MakesNoSlivers) {
  const auto worst = [](const TriangleData& s) {
    Real ratio = 0;
    for (const auto& t : s.triangles) {
      const Real a = length(s, t[0], t[1]), b = length(s, t[1], t[2]), c = length(s, t[2], t[0]);
      ratio = std::max(ratio, std::max({a, b, c}) / std::min({a, b, c}));
    }
    return ratio;
  };
  const TriangleData before = gutter();
  EXPECT_LE(worst(split_convex_edges(before, longest)), worst(before));
}

TEST(SplitEdges, LeavesAloneWhatIsShort) {
  EXPECT_EQ(split_convex_edges(gutter(), 100).points.size(), gutter().points.size());
  EXPECT_EQ(split_convex_edges(gutter(), 0).points.size(), gutter().points.size());
}

}  // namespace
}  // namespace sutura::contact
