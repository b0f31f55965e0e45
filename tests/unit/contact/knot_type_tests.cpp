// Which knot a line is: torus knots cut open, one after another, and what is none.
#include <gtest/gtest.h>

#include <numbers>

#include "knot_type.h"
#include "support/knot_type.h"
#include "support/laid_out_knot.h"

namespace sutura::contact {
namespace {

using Line = std::vector<Vec3>;

/// The torus knot of `p` crossings, cut open where it is outermost, at `x` along the line; between
/// such knots the line goes straight. Right-handed or mirrored.
void tie(Line& line, Real x, int p, bool right) {
  constexpr int points = 150;
  const Real pi = std::numbers::pi, cut = 0.02;
  for (int i = 0; i <= points; ++i) {
    const Real t = cut + (2 * pi - 2 * cut) * i / points;
    const Real r = 2 + std::cos(p * t);
    // The cut is at (3, 0, 0): turned up, its two ends lead out sideways.
    const Vec3 at(r * std::cos(2 * t), r * std::sin(2 * t), std::sin(p * t) * (right ? -1 : 1));
    line.emplace_back(x + at.y(), at.z(), at.x());
  }
}

/// From far away through the throws to far away. Each is left upwards to the next.
Line throws(const std::vector<std::pair<int, bool>>& all) {
  Line line;
  Real x = 0;
  for (const auto& [p, right] : all) {
    tie(line, x, p, right);
    x += 12;
  }
  const Vec3 up(0, 0, 1000);
  line.insert(line.begin(), line.front() + up - Vec3(1000, 0, 0));
  line.push_back(line.back() + up + Vec3(1000, 0, 0));
  return line;
}

TEST(KnotType, OfThrowsUponEachOther) {
  const bool right = true, left = false;
  struct Case {
    std::vector<std::pair<int, bool>> throws;
    Index left, crossings;
    Real determinant;
  };
  const Case cases[] = {
      {{{3, right}}, 0, 3, 3},
      {{{3, left}}, 1, 3, 3},
      {{{5, right}}, 0, 5, 5},
      {{{3, right}, {3, left}}, 1, 6, 9},               // square
      {{{3, right}, {3, right}}, 0, 6, 9},              // granny
      {{{5, left}, {3, right}}, 1, 8, 15},              // surgeon's
      {{{5, left}, {3, right}, {3, left}}, 2, 11, 45},  // with a third throw
      {{{3, right}, {3, left}, {3, right}, {3, left}}, 2, 12, 81},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.determinant);
    const Line line = throws(c.throws);
    const KnotType type = knot_type(line);
    EXPECT_TRUE(type.is_knot);
    EXPECT_TRUE(type.is_known);
    EXPECT_EQ(type.throws, static_cast<Index>(c.throws.size()));
    EXPECT_EQ(type.left, c.left);
    EXPECT_EQ(type.crossings, c.crossings);
    EXPECT_EQ(type.determinant, c.determinant);
    // Another way to the same number: the sum over all states (of a closed line).
    if (c.crossings > 8) continue;
    const auto sum = testing::jones(line), here = jones(line, testing::jones_angle).value();
    EXPECT_LT(std::abs(sum - here), 1e-6) << sum << ' ' << here;
  }
}

TEST(KnotType, FewerPointsDoForTheSame) {
  const Line line = throws({{5, false}, {3, true}});
  const Line few = simplified(line, 0.1);
  EXPECT_LT(few.size(), line.size() / 2);
  EXPECT_EQ(few.front(), line.front());
  EXPECT_EQ(few.back(), line.back());
  for (const Vec3& p : line) {
    Real nearest = 1;
    for (std::size_t i = 0; i + 1 < few.size(); ++i) {
      const Vec3 way = few[i + 1] - few[i];
      const Real part = std::clamp((p - few[i]).dot(way) / way.squaredNorm(), 0., 1.);
      nearest = std::min(nearest, (p - few[i] - part * way).norm());
    }
    EXPECT_LE(nearest, 0.1 + 1e-9);
  }
  EXPECT_EQ(knot_type(few), knot_type(line));
}

TEST(KnotType, OfACurveThatOnlyClimbsIsNone) {
  for (const bool is_knot : {false, true}) {
    Line line;
    for (int i = -60; i <= 60; ++i) line.push_back(testing::long_curve(i * 0.05, is_knot));
    const KnotType type = knot_type(line);
    EXPECT_EQ(type.is_knot, is_knot);
    EXPECT_TRUE(type.is_known);
    EXPECT_EQ(type.throws, is_knot);
    EXPECT_EQ(type.determinant, is_knot ? 3 : 1);
  }
}

/// The figure-eight knot is no throw: it is a knot of determinant 5, and no more is said.
TEST(KnotType, OfAnotherKnotItsDeterminant) {
  Line line;
  for (int i = 1; i < 400; ++i) {
    const Real t = 2 * std::numbers::pi * i / 400;
    line.emplace_back((2 + std::cos(2 * t)) * std::cos(3 * t),
                      (2 + std::cos(2 * t)) * std::sin(3 * t), std::sin(4 * t));
  }
  line.insert(line.begin(), 100 * line.front());
  line.push_back(100 * line.back());
  const KnotType type = knot_type(line);
  EXPECT_TRUE(type.is_knot);
  EXPECT_FALSE(type.is_known);
  EXPECT_EQ(type.throws, 0);
  EXPECT_EQ(type.determinant, 5);
}

}  // namespace
}  // namespace sutura::contact
