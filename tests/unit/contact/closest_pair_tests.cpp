// The closest points of two cubics against brute force.
#include <gtest/gtest.h>

#include <random>

#include "closest_pair.h"

namespace sutura::contact {
namespace {

class Random {
 public:
  Real between(Real low, Real high) {
    return std::uniform_real_distribution<Real>(low, high)(engine_);
  }
  Vec3 anywhere(Real size) {
    Vec3 p;  // one after the other: the order of arguments is the compiler's
    for (Real& x : p) x = between(-size, size);
    return p;
  }
  Vec3 direction() { return anywhere(1).normalized(); }
  /// A beam of 1 mm whose tangents turn by up to `turn` against its chord (rad).
  CurveSegment beam(Real turn) {
    constexpr Real length = 1e-3;
    const Vec3 along = direction();
    const auto turned = [&] {
      const Real angle = between(-turn, turn);
      return Vec3(Eigen::AngleAxis<Real>(angle, direction()) * along);
    };
    CurveSegment s;
    s.xa = anywhere(0.5e-3);
    s.xb = s.xa + length * along;
    s.ma = length * turned();
    s.mb = length * turned();
    s.to = length;
    s.radius = 0.1e-3;
    return s;
  }

 private:
  std::mt19937 engine_{5};
};

/// The smallest distance, by brute force: on a grid, then on a finer one around the best of it.
Real by_force(const CurveSegment& a, const CurveSegment& b) {
  constexpr int n = 60;
  Real u = 0.5, v = 0.5, width = 1, best = 1;
  for (int round = 0; round < 5; ++round, width *= 0.1) {
    const Real from_u = u, from_v = v;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j) {
        const Real s = std::clamp(from_u + width * (Real(i) / n - 0.5), 0., 1.);
        const Real t = std::clamp(from_v + width * (Real(j) / n - 0.5), 0., 1.);
        const Real d = (a.point(s) - b.point(t)).norm();
        if (d < best) best = d, u = s, v = t;
      }
  }
  return best;
}

// Beams of a thread turn by half a radian at most in what a scene should hold: there it is exact,
// but where two places are as close but for what the chords leave out, a tenth of `fine` each.
TEST(ClosestPair, OfBentBeamsIsWhatBruteForceFinds) {
  Random random;
  int others = 0;
  for (int i = 0; i < 300; ++i) {
    const CurveSegment a = random.beam(0.5), b = random.beam(0.5);
    const Real fine = a.radius + b.radius;
    const ClosestPair found = closest_on(a, b, fine);
    const Vec3 apart = a.point(found.u) - b.point(found.v);
    EXPECT_NEAR((found.apart - apart).norm(), 0, 1e-15);
    const Real least = by_force(a, b);
    EXPECT_GT(found.distance, least - 1e-8) << i;  // m
    EXPECT_LT(found.distance, least + 0.2 * fine) << i;
    others += found.distance > least + 1e-8;
  }
  EXPECT_LE(others, 3);
}

TEST(ClosestPair, OfAPointIsWhatBruteForceFinds) {
  Random random;
  for (int i = 0; i < 300; ++i) {
    const CurveSegment b = random.beam(0.5);
    CurveSegment point;
    point.xa = point.xb = random.anywhere(1e-3);
    point.ma = point.mb = Vec3::Zero();
    const ClosestPair found = closest_to(point.xa, 0.3, b);
    EXPECT_EQ(found.u, 0.3);
    EXPECT_NEAR(found.distance, by_force(point, b), 1e-8) << i;  // m
  }
}

}  // namespace
}  // namespace sutura::contact
