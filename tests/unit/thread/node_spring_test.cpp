// The spring of a hold: its moment is minus the derivative of its energy, at any roll and tilt, and
// the roll is counted through whole turns.
#include <gtest/gtest.h>

#include <numbers>

#include "chain_motion.h"
#include "rod.h"

namespace sutura::thread {
namespace {

constexpr Real whole = 2 * std::numbers::pi;

NodeSpring spring_with(const Quat& target, Real roll) {
  NodeSpring spring;
  spring.target.rotation = target;
  spring.target.position = {1e-3, -2e-3, 0.5e-3};
  spring.stiffness = {3, 0.7};
  spring.roll = roll;
  return spring;
}

TEST(NodeSpring, WrenchIsMinusTheDerivativeOfTheEnergy) {
  const Pose section{{0.2e-3, 0, 0}, rotated(Quat::Identity(), Vec3(0.3, -0.2, 0.6))};
  const Vec3 along = tangent(section), across = section.rotation * Vec3(0, 0.6, 0.8);
  for (const Real tilt : {0., 0.4, 1.5, 2.5})
    for (const Real roll : {0., 2., whole, 20.}) {
      const Quat target = rotated(rotated(section.rotation, roll * along), tilt * across);
      const NodeSpring spring = spring_with(target, roll);
      EXPECT_NEAR(spring.roll_at(section.rotation, Vec3::Zero()), roll, 1e-12);
      const auto energy = [&](const Vec3& shift, const Vec3& spin) {
        const Pose at{section.position + shift, rotated(section.rotation, spin)};
        return spring.energy(at, spring.roll_at(at.rotation, Vec3::Zero()));
      };
      const Wrench w = spring.wrench(section, roll);
      // Central differences: an energy of up to 150 J is rounded by 3e-14 J, and 3e-9 are left.
      constexpr Real step = 1e-5;
      for (int d = 0; d < 3; ++d) {
        const Vec3 by = step * Vec3::Unit(d), none = Vec3::Zero();
        EXPECT_NEAR(-w.force[d], (energy(by, none) - energy(-by, none)) / (2 * step), 1e-7);
        EXPECT_NEAR(-w.moment[d], (energy(none, by) - energy(none, -by)) / (2 * step), 1e-7)
            << tilt << ' ' << roll;
      }
    }
}

// Rolled by three turns back in a step, and by a quarter of a turn more than one forth.
TEST(NodeSpring, CountsWhatTheSectionRollsInAStep) {
  const Quat start = rotated(Quat::Identity(), Vec3(0.3, -0.2, 0.6));
  const Vec3 along = start * Vec3::UnitX(), across = start * Vec3::UnitZ();
  const NodeSpring spring = spring_with(rotated(start, 0.5 * along), 0.5 + whole);
  const auto roll_after = [&](const Vec3& motion) { return spring.roll_at(start, motion); };
  EXPECT_NEAR(roll_after(Vec3::Zero()), 0.5 + whole, 1e-12);
  EXPECT_NEAR(roll_after(-3 * whole * along), 0.5 + 4 * whole, 1e-12);
  EXPECT_NEAR(roll_after(1.25 * whole * along), 0.5 - 0.25 * whole, 1e-12);
  // A tilt about an axis across the tangent does not roll.
  EXPECT_NEAR(roll_after(-3 * whole * along + 0.8 * across), 0.5 + 4 * whole, 1e-12);
}

}  // namespace
}  // namespace sutura::thread
