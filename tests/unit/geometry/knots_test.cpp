// The judges of tests/support/knots.h on knots and links whose invariants are in every table.
#include "support/knots.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace sutura::testing {
namespace {

using Line = std::vector<Vec3>;
constexpr Real turn = 2 * std::numbers::pi;

Line closed(int points, const std::function<Vec3(Real)>& at) {
  Line line;
  for (int i = 0; i < points; ++i) line.push_back(at(turn * i / points));
  return line;
}

Vec3 circle(Real t) {
  return {std::cos(t), std::sin(t), 0};
}
Vec3 trefoil(Real t) {
  return {std::sin(t) + 2 * std::sin(2 * t), std::cos(t) - 2 * std::cos(2 * t), -std::sin(3 * t)};
}
Vec3 figure_eight(Real t) {
  return {(2 + std::cos(2 * t)) * std::cos(3 * t), (2 + std::cos(2 * t)) * std::sin(3 * t),
          std::sin(4 * t)};
}
/// Winds p times round the axis and q times round the circle.
Vec3 torus_knot(Real t, int p, int q) {
  const Real r = 2 + std::cos(q * t);
  return {r * std::cos(p * t), r * std::sin(p * t), std::sin(q * t)};
}

/// The same line in several random turns, and seen in a mirror.
void expect_knot(const Line& line, Real at_minus_one, Real at_cube_root) {
  std::mt19937 random(1);
  std::normal_distribution<Real> normal;
  for (int i = 0; i < 20; ++i) {
    const Quat q =
        Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
    Line turned = line;
    for (Vec3& p : turned) p = q * (i % 2 ? Vec3(p.x(), p.y(), -p.z()) : p);
    const KnotInvariant found = knot_invariant(turned);
    EXPECT_NEAR(found.at_minus_one, at_minus_one, 1e-6) << i;
    EXPECT_NEAR(found.at_cube_root, at_cube_root, 1e-6) << i;
  }
}

// Alexander polynomials, at -1 and at a cube root of unity w, where w + 1/w = -1 and
// w^2 + 1/w^2 = -1.
TEST(Knots, AlexanderPolynomials) {
  expect_knot(closed(40, circle), 1, 1);
  expect_knot(closed(100, trefoil), 3, 2);                                     // t - 1 + 1/t
  expect_knot(closed(160, figure_eight), 5, 4);                                // -t + 3 - 1/t
  expect_knot(closed(160, [](Real t) { return torus_knot(t, 2, 5); }), 5, 1);  // t^2 - t + 1 - ...
  // A circle with curls is no knot.
  expect_knot(closed(200,
                     [](Real t) {
                       return Vec3(std::cos(t) + 0.5 * std::cos(7 * t),
                                   std::sin(t) + 0.5 * std::sin(7 * t), 0.3 * std::cos(t));
                     }),
              1, 1);
}

TEST(Knots, LinkingNumbers) {
  const Line first = closed(40, circle);
  const auto link = [&](const Line& other) { return linking_number(first, other); };
  const Line hopf = closed(50, [](Real t) { return Vec3(1 + std::cos(t), 0, std::sin(t)); });
  EXPECT_NEAR(std::abs(link(hopf)), 1, 1e-9);
  Line back(hopf.rbegin(), hopf.rend());
  EXPECT_NEAR(link(back), -link(hopf), 1e-9);
  // Beside it, and hung into it and out again.
  EXPECT_NEAR(link(closed(50, [](Real t) { return Vec3(3 + std::cos(t), 0, std::sin(t)); })), 0,
              1e-9);
  EXPECT_NEAR(link(closed(50, [](Real t) { return Vec3(std::sin(t), 0, 0.1 * std::cos(t)); })), 0,
              1e-9);
  // Three times round the circle of the first.
  EXPECT_NEAR(std::abs(link(closed(200,
                                   [](Real t) {
                                     const Real r = 1 + 0.3 * std::cos(3 * t);
                                     return Vec3(r * std::cos(t), r * std::sin(t),
                                                 0.3 * std::sin(3 * t));
                                   }))),
              3, 1e-9);
}

}  // namespace
}  // namespace sutura::testing
