// How two strands that touch turn as one: what each rolls is told from what both turn.
#include <gtest/gtest.h>

#include <random>

#include "common_turn.h"
#include "sutura/geometry/poses.h"

namespace sutura::contact {
namespace {

constexpr Real reach = 0.2e-3;
constexpr Real rounding = 1e-12;

Real angle_between(const Quat& p, const Quat& q) {
  return p.angularDistance(q);
}
Quat roll(Real angle) {
  return Quat(Eigen::AngleAxis<Real>(angle, Vec3::UnitX()));
}

/// Two strands that touch above each other, the second turned by `crossing`.
struct Strands {
  explicit Strands(Real crossing)
      : a{Vec3(0, 0, reach), roll(0.3)},
        b{Vec3::Zero(), Quat(Eigen::AngleAxis<Real>(crossing, Vec3::UnitZ())) * roll(-1.1)} {}
  Pose a, b;
};

// Turned as a rigid body, by up to 2 rad, while each rolls as far as it likes.
TEST(CommonTurn, IsThatOfARigidMotionWhateverEachRolls) {
  std::mt19937 random(1);
  std::uniform_real_distribution<Real> any(-1, 1);
  for (const Real crossing : {0., 1e-3, 0.2, 1.0, 1.57, 2.5, 3.14159}) {
    for (int i = 0; i < 100; ++i) {
      const Strands start(crossing);
      const Vec3 turn = 2 * any(random) * Vec3(any(random), any(random), any(random)).normalized();
      const Pose motion{Vec3(any(random), any(random), any(random)),
                        Quat(Eigen::AngleAxis<Real>(turn.norm(), turn.normalized()))};
      Pose a = compose(motion, start.a), b = compose(motion, start.b);
      a.rotation = a.rotation * roll(9 * any(random));
      b.rotation = b.rotation * roll(9 * any(random));
      // Positions of a metre leave the line between the centres with 1e-12 of its length.
      EXPECT_LT(angle_between(common_turn(start.a, a, start.b, b, reach), motion.rotation), 1e-10)
          << crossing;
    }
  }
}

// A strand that goes round another one which lies along it: that is the turn, not what they roll.
TEST(CommonTurn, FollowsTheLineBetweenStrandsAlongEachOther) {
  const Strands start(0);
  Pose a = start.a, b = start.b;
  const Quat round(Eigen::AngleAxis<Real>(0.7, Vec3::UnitX()));
  a.position = round * a.position;
  a.rotation = a.rotation * roll(3), b.rotation = b.rotation * roll(-5);
  EXPECT_LT(angle_between(common_turn(start.a, a, start.b, b, reach), round), rounding);
}

// One that only lands now has not gone round the other by the angle to where it came from.
TEST(CommonTurn, IsLittleWhereTheyDidNotTouchAtTheStart) {
  const Strands start(0);
  Pose a0 = start.a;
  a0.position += Vec3(0, 3, 1) * reach;
  const Real angle =
      angle_between(common_turn(a0, start.a, start.b, start.b, reach), Quat::Identity());
  EXPECT_LT(angle, 0.01);
}

}  // namespace
}  // namespace sutura::contact
