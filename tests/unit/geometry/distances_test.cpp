// Closest points are minima of convex functions over convex sets, so they are proved by their
// variational inequality: q is the point of a set closest to p if no point of the set lies on p's
// side of q, (p - q) . (v - q) <= 0 for all its corners v. For two sets it holds of each point
// against the other set.
#include "sutura/geometry/distances.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace sutura {
namespace {

// Coordinates are of order 1; what is left is rounding, amplified by triangles a hundred times
// longer than wide.
constexpr Real rounding = 1e-12;

struct Draw {
  std::mt19937 random{11};
  Real number(Real low, Real high) {
    return std::uniform_real_distribution<Real>(low, high)(random);
  }
  Vec3 point() {
    const Real x = number(-1, 1), y = number(-1, 1), z = number(-1, 1);
    return {x, y, z};
  }
  /// On a grid of three: parallel, collinear, coplanar, touching and of length zero are frequent.
  Vec3 grid_point() {
    std::uniform_int_distribution<int> cell(-1, 1);
    const int x = cell(random), y = cell(random), z = cell(random);
    return Vec3(x, y, z);
  }
};

/// How far some corner lies on p's side of q; at most zero where q is closest.
Real excess(const Vec3& p, const Vec3& q, const std::vector<Vec3>& corners) {
  Real most = -1;
  for (const Vec3& v : corners) most = std::max(most, (p - q).dot(v - q));
  return most;
}
std::vector<Vec3> ends(const Segment& s) {
  return {s.a, s.b};
}
std::vector<Vec3> corners_of(const Corners& t) {
  return {t.begin(), t.end()};
}
void expect_weights(const Vec3& w) {
  EXPECT_GE(w.minCoeff(), 0);
  EXPECT_NEAR(w.sum(), 1, rounding);
}

void check(const Vec3& p, const Corners& t) {
  const TrianglePoint q = closest_point(p, t);
  expect_weights(q.weights);
  EXPECT_LE(excess(p, q.on(t), corners_of(t)), rounding);
  if (q.corner >= 0) {
    EXPECT_EQ(q.weights[q.corner], 1);
  }
  if (q.edge >= 0) {
    EXPECT_EQ(q.weights[(q.edge + 2) % 3], 0);
  }
}
void check(const Segment& p, const Segment& q) {
  const SegmentPair pair = closest_points(p, q);
  for (const Real x : {pair.s, pair.t}) {
    EXPECT_GE(x, 0);
    EXPECT_LE(x, 1);
  }
  const Vec3 a = p.at(pair.s), b = q.at(pair.t);
  EXPECT_NEAR(pair.squared_distance, (a - b).squaredNorm(), rounding);
  EXPECT_LE(excess(a, b, ends(q)), rounding);
  EXPECT_LE(excess(b, a, ends(p)), rounding);
}
void check(const Segment& p, const Corners& t) {
  const SegmentTriangle pair = closest_points(p, t);
  EXPECT_GE(pair.s, 0);
  EXPECT_LE(pair.s, 1);
  expect_weights(pair.weights);
  const Vec3 a = p.at(pair.s);
  const Vec3 b = TrianglePoint{.weights = pair.weights}.on(t);
  EXPECT_NEAR(pair.squared_distance, (a - b).squaredNorm(), rounding);
  EXPECT_LE(excess(a, b, corners_of(t)), rounding);
  EXPECT_LE(excess(b, a, ends(p)), rounding);
}

TEST(Distances, OfRandomPairsAreMinima) {
  Draw draw;
  for (int i = 0; i < 20000; ++i) {
    const auto p = [&draw] { return draw.point(); };
    check(p(), Corners{p(), p(), p()});
    check(Segment{p(), p()}, Segment{p(), p()});
    check(Segment{p(), p()}, Corners{p(), p(), p()});
  }
}

TEST(Distances, OfDegeneratePairsAreMinima) {
  Draw draw;
  for (int i = 0; i < 20000; ++i) {
    const auto p = [&draw] { return draw.grid_point(); };
    check(p(), Corners{p(), p(), p()});
    check(Segment{p(), p()}, Segment{p(), p()});
    check(Segment{p(), p()}, Corners{p(), p(), p()});
  }
}

// Parallel up to rounding, in a direction that has no exact digits: s and t of the two lines are
// noise there, and the distance must not be.
TEST(Distances, OfNearlyParallelSegmentsAreMinima) {
  Draw draw;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 along = draw.point(), a = draw.point(), b = draw.point();
    const Real tilt = std::pow(10, draw.number(-18, -6));
    const Segment p{a, a + along}, q{b, b + draw.number(-1, 1) * along + tilt * draw.point()};
    check(p, q);
    check(p, Corners{q.a, q.b, draw.point()});
  }
}

TEST(Distances, OfCrossingSegmentAndTriangleIsZero) {
  const Corners t{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  const SegmentTriangle through = closest_points(Segment{{0.2, 0.3, 1}, {0.2, 0.3, -3}}, t);
  EXPECT_EQ(through.squared_distance, 0);
  EXPECT_NEAR(through.s, 0.25, rounding);
  EXPECT_LT((through.weights - Vec3(0.5, 0.2, 0.3)).norm(), rounding);
  // Past the long edge, at (1, 1, 0) / sqrt 2 from its middle.
  const SegmentTriangle beside = closest_points(Segment{{1, 1, 1}, {1, 1, -1}}, t);
  EXPECT_NEAR(beside.squared_distance, 0.5, rounding);
  EXPECT_NEAR(beside.s, 0.5, rounding);
}

}  // namespace
}  // namespace sutura
