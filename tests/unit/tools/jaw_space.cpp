// What is between open jaws: areas and lengths against geometry.
#include "jaw_space.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace sutura::tools {
namespace {

constexpr Real rounding = 1e-12;

TEST(JawSpace, ATriangleAcrossItIsCutToARectangle) {
  // It spans far over the box at z = 0.1: what is left is the section of the box.
  const JawSpace space{Vec3(2, 1, 0.5)};
  const Corners large{Vec3(-20, -20, 0.1), Vec3(20, -20, 0.1), Vec3(0, 30, 0.1)};
  const JawSpace::Part part = space.part(large);
  EXPECT_NEAR(part.area, 4 * 2, rounding);
  const Vec3 centroid =
      part.weights[0] * large[0] + part.weights[1] * large[1] + part.weights[2] * large[2];
  EXPECT_LT((centroid - Vec3(0, 0, 0.1)).norm(), rounding);
  EXPECT_EQ(space.part({Vec3(3, 0, 0), Vec3(4, 0, 0), Vec3(3, 1, 0)}).area, 0);
}

// The parts of a cut triangle in eight boxes that fill the space around it add up to all of it.
TEST(JawSpace, PartsAddUp) {
  std::mt19937 random(3);
  std::uniform_real_distribution<Real> in(-1, 1);
  for (int i = 0; i < 200; ++i) {
    Corners t;
    for (Vec3& c : t) c = Vec3::NullaryExpr([&] { return in(random); });
    Real area = 0;
    Vec3 moment = Vec3::Zero();
    for (int octant = 0; octant < 8; ++octant) {
      const Vec3 centre((octant & 1) - 0.5, ((octant >> 1) & 1) - 0.5, (octant >> 2) - 0.5);
      Corners seen = t;
      for (Vec3& c : seen) c -= centre;
      const JawSpace::Part part = JawSpace{Vec3::Constant(0.5)}.part(seen);
      area += part.area;
      moment += part.area * part.weights;
    }
    EXPECT_NEAR(area, (t[1] - t[0]).cross(t[2] - t[0]).norm() / 2, rounding);
    EXPECT_LT((moment / area - Vec3::Constant(1. / 3)).norm(), 1e-9);
  }
}

/// Straight segments of length 1 through the points.
std::vector<CurveSegment> polyline(const std::vector<Vec3>& points) {
  std::vector<CurveSegment> out;
  Real s = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec3 along = points[i] - points[i - 1];
    out.push_back({s, s + along.norm(), points[i - 1], along, points[i], along, 0.01});
    s += along.norm();
  }
  return out;
}

TEST(JawSpace, StretchesBeginAndEndAtItsSides) {
  const JawSpace space{Vec3(0.5, 0.5, 0.5)};
  std::vector<JawSpace::Stretch> found;
  // There, beyond, and back at another height: two strands.
  space.stretches(polyline({{-2, 0, 0}, {-0.2, 0, 0}, {2, 0, 0}, {2, 0.3, 0}, {-2, 0.3, 0}}),
                  found);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].low, 1.5, 1e-9);
  EXPECT_NEAR(found[0].high, 2.5, 1e-9);
  EXPECT_NEAR(found[1].low, 4.3 + 1.5, 1e-9);
  EXPECT_NEAR(found[1].high, 4.3 + 2.5, 1e-9);
  EXPECT_LT((found[1].middle - Vec3(0, 0.3, 0)).norm(), 1e-9);
  // One that ends inside ends with the curve.
  space.stretches(polyline({{-2, 0, 0}, {0.1, 0, 0}}), found);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].high, 2.1, rounding);
  space.stretches(polyline({{-2, 0.6, 0}, {2, 0.6, 0}}), found);
  EXPECT_TRUE(found.empty());
}

/// A line along `way`, its middle there.
Strand straight(Index curve, const Vec3& middle, const Vec3& way) {
  Strand out{.curve = curve, .radius = 0.1, .high = 2 * way.norm(), .line = {}};
  for (int k = -4; k <= 4; ++k) out.line.push_back(middle + k / 4. * way);
  return out;
}

// At 0.01 over their thickness, 0.2: what is left of their heights is known where they meet.
TEST(JawSpace, StrandsArePressedUntilTheyMeet) {
  const Vec3 x(1, 0, 0), y(0, 1, 0);
  const auto flat = [&](const Vec3& middle, const Vec3& way) {
    return flattest({straight(0, {0, 0, 0.5}, x), straight(1, middle, way)});
  };
  constexpr Real near = 1e-8;
  EXPECT_NEAR(flat({0, 0, -0.5}, x), 0.202, near);
  EXPECT_NEAR(flat({0.3, 0.2, -0.5}, y), 0.202, near);
  EXPECT_NEAR(flat({0, 0.1, -0.5}, x), std::sqrt(0.202 * 0.202 - 0.01), near);
  EXPECT_NEAR(flat({0.3, 0, -0.5}, {0.1, 1, 0.8}), 0.202, 0.01);  // askew
  EXPECT_EQ(flat({0, 0.203, -0.5}, x), 0);                        // they lie beside each other
  EXPECT_EQ(flat({0, 0.1, 0.55}, x), 1);                          // they touch
  // The two that meet first.
  EXPECT_NEAR(flattest({straight(0, {0, 0, 0.5}, x), straight(1, {0, 0, -0.5}, x),
                        straight(2, {0, 0, 0.1}, y)}),
              0.202 / 0.4, near);
}

TEST(JawSpace, AStrandIsInItsOwnWayWhereItTurnsBack) {
  EXPECT_EQ(flattest({straight(0, Vec3::Zero(), {0.3, 0, 1})}), 0);
  Strand bend{.radius = 0.1, .high = 2 + std::numbers::pi / 2, .line = {}};
  for (int k = 0; k <= 64; ++k) {
    const Real s = k / 64. * bend.high, angle = std::clamp((s - 1) / 0.5, 0., std::numbers::pi);
    const Real leg = std::abs(s - bend.high / 2) - std::numbers::pi / 4;
    bend.line.push_back({0.5 * std::sin(angle) - std::max(leg, 0.), 0, 0.5 * std::cos(angle)});
  }
  // Its legs meet at 0.202, its bend earlier where it has turned by a right angle.
  EXPECT_GT(flattest({bend}), 0.202);
  EXPECT_LT(flattest({bend}), 0.202 * std::sqrt(2) * 1.1);
}

}  // namespace
}  // namespace sutura::tools
