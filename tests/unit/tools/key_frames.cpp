// Key frames: closed forms of rigid motions.
#include "key_frames.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace sutura::tools {
namespace {

constexpr Real pi = std::numbers::pi;
// A handful of roundings of numbers of size one.
constexpr Real rounding = 1e-14;

Vec3 moved(const KeyFrames& f, Real t, const Vec3& x) {
  const Pose p = f.at(t);
  return p.position + p.rotation * x;
}

TEST(KeyFrames, RestsBeforeTheFirstAndAfterTheLastKey) {
  const KeyFrames f({{1, {1, 2, 3}, {0, 0, 0}}, {2, {4, 5, 6}, {0, 0, 0}}}, Vec3::Zero(),
                    Easing::linear);
  EXPECT_EQ(f.at(-5).position, Vec3(1, 2, 3));
  EXPECT_EQ(f.at(1).position, Vec3(1, 2, 3));
  EXPECT_EQ(f.at(2).position, Vec3(4, 5, 6));
  EXPECT_EQ(f.at(1e9).position, Vec3(4, 5, 6));
}

TEST(KeyFrames, LinearPositionsAtConstantSpeed) {
  const KeyFrames f({{0, {0, 0, 0}, {0, 0, 0}}, {4, {8, 0, -4}, {0, 0, 0}}}, Vec3::Zero(),
                    Easing::linear);
  EXPECT_TRUE(f.at(1).position.isApprox(Vec3(2, 0, -1), rounding));
  EXPECT_TRUE(f.at(3).position.isApprox(Vec3(6, 0, -3), rounding));
}

TEST(KeyFrames, SmoothEasingIsAtRestAtEveryKey) {
  const KeyFrames f(
      {{0, {0, 0, 0}, {0, 0, 0}}, {1, {1, 0, 0}, {0, 0, 0}}, {3, {0, 0, 0}, {0, 0, 0}}},
      Vec3::Zero(), Easing::smooth);
  EXPECT_NEAR(f.at(0.5).position.x(), 0.5, rounding);
  EXPECT_NEAR(f.at(0.25).position.x(), 3 * 0.0625 - 2 * 0.015625, rounding);
  // s(h) = 3 h^2 - 2 h^3 near the key: no first-order term.
  EXPECT_NEAR(f.at(1e-3).position.x(), 3e-6, 3e-9);
  EXPECT_NEAR(1 - f.at(1 - 1e-3).position.x(), 3e-6, 3e-9);
  EXPECT_NEAR(1 - f.at(1 + 2e-3).position.x(), 3e-6, 3e-9);
}

// The point of the track of a needle: one rotation key carries every point of the needle along its
// arc, at constant distance from the centre.
TEST(KeyFrames, RotationAboutTheCentreFollowsTheArc) {
  const Vec3 centre(1, 2, 3);
  const Real radius = 8.276e-3;
  const KeyFrames f({{0, {0, 0, 0}, {0, 0, 0}}, {2, {0, 0, 0}, {0, pi / 2, 0}}}, centre,
                    Easing::linear);
  for (const Real t : {0.0, 0.3, 1.0, 1.7, 2.0}) {
    const Real angle = pi / 2 * t / 2;
    // Right-handed about y: x turns towards -z.
    const Vec3 expected = centre + radius * Vec3(std::cos(angle), 0, -std::sin(angle));
    EXPECT_LT((moved(f, t, centre + Vec3(radius, 0, 0)) - expected).norm(), rounding) << t;
    EXPECT_LT((moved(f, t, centre) - centre).norm(), rounding) << t;
  }
}

TEST(KeyFrames, KeysAboutOneAxisMayLieMoreThanHalfATurnApart) {
  for (const Real degrees : {170.0, 190.0, 350.0, 360.0, 540.0, -200.0, -720.0}) {
    const Real total = degrees * pi / 180;
    const KeyFrames f({{0, {0, 0, 0}, {0, 0, 0.1}}, {1, {0, 0, 0}, {0, 0, 0.1 + total}}},
                      Vec3::Zero(), Easing::linear);
    for (const Real u : {0.25, 0.5, 0.75}) {
      const Real angle = 0.1 + u * total;
      const Vec3 expected(std::cos(angle), std::sin(angle), 0);
      // Angles of size 12 rad carry 12 roundings of their own.
      EXPECT_LT((moved(f, u, Vec3::UnitX()) - expected).norm(), 1e-13) << degrees << " " << u;
    }
  }
}

TEST(KeyFrames, TellTheLargestTurnInAStep) {
  const std::vector<KeyFrame> keys = {
      {0, {0, 0, 0}, {0, 0, 0}}, {1, {0, 0, 0}, {0, 0, 10}}, {1.1, {0, 0, 0}, {0, 0, 8}}};
  EXPECT_NEAR(KeyFrames(keys, Vec3::Zero(), Easing::linear).largest_turn(0.2), 2, rounding);
  EXPECT_NEAR(KeyFrames(keys, Vec3::Zero(), Easing::linear).largest_turn(0.05), 1, rounding);
  // From 0.4 to 0.6 of the way: 3 u^2 - 2 u^3 there is 0.352 and 0.648.
  EXPECT_NEAR(KeyFrames(keys, Vec3::Zero(), Easing::smooth).largest_turn(0.2), 2.96, rounding);
}

TEST(KeyFrames, SlerpBetweenDifferentAxesTakesTheShortWay) {
  const KeyFrames f({{0, {0, 0, 0}, {0.4, 0, 0}}, {1, {0, 0, 0}, {0, 0.7, 0}}}, Vec3::Zero(),
                    Easing::linear);
  const Quat a = rotation_from_vector({0.4, 0, 0});
  const Quat b = rotation_from_vector({0, 0.7, 0});
  for (const Real u : {0.2, 0.5, 0.9}) {
    EXPECT_LT(f.at(u).rotation.angularDistance(a.slerp(u, b)), 1e-7);  // acos near 1: sqrt(eps)
    EXPECT_NEAR(f.at(u).rotation.norm(), 1, rounding);
  }
}

TEST(KeyFrames, CheckSaysWhatIsWrong) {
  const Vec3 zero = Vec3::Zero();
  EXPECT_NE(KeyFrames::check({}).find("at least one"), std::string::npos);
  EXPECT_EQ(KeyFrames::check({{0, zero, zero}}), "");
  EXPECT_NE(KeyFrames::check({{0, zero, zero}, {0, zero, zero}}).find("key 2"), std::string::npos);
  EXPECT_NE(KeyFrames::check({{1, zero, zero}, {0.5, zero, zero}}).find("0.5 s"),
            std::string::npos);
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  EXPECT_NE(KeyFrames::check({{nan, zero, zero}}), "");
  EXPECT_NE(KeyFrames::check({{0, {0, nan, 0}, zero}}), "");
  EXPECT_NE(KeyFrames::check({{0, zero, {0, 0, nan}}}), "");
}

}  // namespace
}  // namespace sutura::tools
