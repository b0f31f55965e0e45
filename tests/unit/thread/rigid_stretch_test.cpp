// Stretches of a rod that move as rigid bodies, against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "rod_builder.h"
#include "rod_step.h"

namespace sutura::thread {
namespace {

constexpr Real pi = std::numbers::pi;

Rod straight(Real length, Index beams) {
  Rod rod;
  rod.build(straight_layout(length, beams, nylon()));
  return rod;
}

/// Thrown in waves, with two stretches that a first step has bent.
Rod thrown_and_bent(Index first, Index last) {
  Rod rod = straight(0.2, 40);
  for (Index i = 0; i < rod.nodes(); ++i) {
    const Real x = rod.abscissa()[i];
    rod.velocity().segment<3>(6 * i) = 0.1 * Vec3(0.3, std::sin(20 * x), 0.5 + std::cos(15 * x));
    rod.velocity().segment<3>(6 * i + 3) = Vec3(2, 1.5 * std::sin(15 * x), 2 * std::cos(20 * x));
  }
  RodStep step(rod);
  const VecX none = VecX::Zero(rod.dofs());
  for (int i = 0; i < 5; ++i) EXPECT_GT(step.advance(rod, 5e-3, Vec3::Zero(), none, 1e-5), 0);
  rod.make_rigid({0, first, last});
  return rod;
}

/// The largest change of a distance between nodes of the stretch, or of a section's turn against
/// another.
Real change_of_shape(const std::vector<Pose>& before, const std::vector<Pose>& after, Index first,
                     Index last) {
  Real most = 0;
  for (Index i = first; i <= last; ++i)
    for (Index k = first; k < i; ++k) {
      const auto apart = [i, k](const std::vector<Pose>& p) {
        return Vec3(p[k].rotation.conjugate() * (p[i].position - p[k].position));
      };
      const auto turn = [i, k](const std::vector<Pose>& p) {
        return p[k].rotation.conjugate() * p[i].rotation;
      };
      most = std::max(
          {most, (apart(after) - apart(before)).norm(), turn(after).angularDistance(turn(before))});
    }
  return most;
}

// Free, it keeps its linear momentum to rounding, at any step; and the stretch its shape.
TEST(RigidStretch, AThrownRodKeepsItsMomentumAndTheStretchItsShape) {
  for (const Index last : {13, 40}) {
    for (const Real dt : {1e-3, 10e-3}) {
      Rod rod = thrown_and_bent(10, last);
      const std::vector<Pose> shape = rod.poses();
      RodStep step(rod);
      const VecX none = VecX::Zero(rod.dofs());
      const Vec3 gravity(0, 0, -9.81);
      for (int i = 0; i < 20; ++i) {
        const Vec3 before = rod.momentum();
        const Index passes = step.advance(rod, dt, gravity, none, 1e-5);
        ASSERT_GT(passes, 0) << last << ' ' << dt << ' ' << i;
        EXPECT_LE(passes, 12);  // as of a rod without stretches (rod_step_test.cpp)
        const Real left = dt * step.imbalance(rod, none).force * static_cast<Real>(rod.nodes());
        EXPECT_LE((rod.momentum() - before - dt * rod.mass() * gravity).norm(),
                  left + 1e-12 * (before.norm() + dt * rod.mass() * gravity.norm()));
      }
      EXPECT_LT(change_of_shape(shape, rod.poses(), 10, last), 1e-12);
    }
  }
}

// A cantilever gives way where it is not rigid only: the end goes by F/EI times the integral of
// (L - x)^2 over the rest of it.
TEST(RigidStretch, ACantileverIsStiffThere) {
  const Real L = 0.1, force = 1e-6;
  Rod rod = straight(L, 20);
  rod.clamp(0);
  rod.make_rigid({0, 6, 13});
  const Real a = rod.abscissa()[6], b = rod.abscissa()[13];
  RodStep step(rod);
  VecX load = VecX::Zero(rod.dofs());
  load[6 * 20 + 2] = force;
  step.set_load(load);
  const VecX none = VecX::Zero(rod.dofs());
  for (int i = 0; i < 10; ++i) ASSERT_GT(step.advance(rod, 10, Vec3::Zero(), none, 1e-5), 0);
  const Real expected = force / nylon().bending_stiffness() *
                        (std::pow(L, 3) - std::pow(L - a, 3) + std::pow(L - b, 3)) / 3;
  // The slope, some 1e-2, counts in second order, and so does shear: 10 (d / L)^2.
  EXPECT_NEAR(rod.poses()[20].position.z(), expected, 2e-4 * expected);
  // In a stretch at the clamp nothing moves at all.
  Rod root = straight(L, 20);
  root.clamp(0);
  root.make_rigid({0, 0, 10});
  RodStep root_step(root);
  root_step.set_load(load);
  for (int i = 0; i < 10; ++i) ASSERT_GT(root_step.advance(root, 10, Vec3::Zero(), none, 1e-5), 0);
  EXPECT_EQ(root.poses()[10].position.z(), 0);
  const Real half = force / nylon().bending_stiffness() * std::pow(L / 2, 3) / 3;
  EXPECT_NEAR(root.poses()[20].position.z(), half, 2e-4 * half);
}

// A rod that is rigid from end to end and spins across its axis: implicit Euler takes the positions
// of the end and the velocities of the chord, so a step of angle a leaves 1 / (1 + a^2) of the spin
// up to a^4, and the turning of the way counts likewise: the loss halves with the step.
TEST(RigidStretch, ASpinningStretchLosesSpinInSecondOrderOfItsTurnOnly) {
  Real lost[2];
  for (int k = 0; k < 2; ++k) {
    const Real dt = k == 0 ? 4e-3 : 2e-3, spin = 20;
    Rod rod = straight(0.05, 10);
    for (Index i = 0; i < rod.nodes(); ++i) {
      rod.velocity().segment<3>(6 * i) = Vec3(0, spin * (rod.abscissa()[i] - 0.025), 0);
      rod.velocity()[6 * i + 5] = spin;
    }
    rod.make_rigid({0, 0, 10});
    RodStep step(rod);
    const VecX none = VecX::Zero(rod.dofs());
    const Real before = rod.angular_momentum().z();
    for (Real t = 0; t < 0.0799; t += dt) ASSERT_GT(step.advance(rod, dt, Vec3::Zero(), none), 0);
    lost[k] = 1 - rod.angular_momentum().z() / before;
    EXPECT_LT(rod.momentum().norm(), 1e-12 * rod.mass());
  }
  EXPECT_GT(lost[0], 0);
  EXPECT_LT(lost[0], 0.2);
  EXPECT_NEAR(lost[0] / lost[1], 2, 0.2);
}

// A rod in two rigid halves, joined by one beam: a pendulum that hangs from a clamp swings with the
// period of a rigid rod, 2 pi sqrt(2 L / 3 g).
TEST(RigidStretch, HungUpItSwingsAsARigidRod) {
  // The soft beam at the top is a hinge of a thousandth of the length.
  RodLayout layout = straight_layout(0.1, 10, nylon(), -Vec3::UnitZ());
  layout.sections[0].bending_factor = 1e-6;
  layout.abscissa[1] = 1e-4;
  layout.rest[1].position = layout.start[1].position = Vec3(0, 0, -1e-4);
  Rod rod;
  rod.build(layout);
  rod.clamp(0);
  rod.make_rigid({0, 1, 10});
  const Real swing = 0.01;
  for (Index i = 1; i < rod.nodes(); ++i) {
    rod.velocity().segment<3>(6 * i) = swing * Vec3(rod.abscissa()[i], 0, 0);
    rod.velocity()[6 * i + 4] = -swing;
  }
  RodStep step(rod);
  const VecX none = VecX::Zero(rod.dofs());
  const Real dt = 0.5e-3, g = 9.81;
  Real half = 0;  // until it hangs straight down again
  Real before = 0;
  for (Real t = 0; t < 1; t += dt) {
    ASSERT_GT(step.advance(rod, dt, Vec3(0, 0, -g), none, 1e-6), 0);
    const Real now = rod.poses()[10].position.x();
    if (now < 0) {
      half = t + dt * before / (before - now);
      break;
    }
    before = now;
  }
  // A hinge of a thousandth, and implicit Euler, which slows by (omega h)^2 / 2 < 1e-4.
  EXPECT_NEAR(half, pi * std::sqrt(2 * 0.1 / (3 * g)), 3e-3 * half);
}

// While the rest straightens, the beams of the stretch keep strain, twist and bend; and go on from
// there.
TEST(RigidStretch, ReleasedItHasTheForcesThatItHad) {
  Rod rod = thrown_and_bent(10, 20);
  const Real energy = rod.elastic_energy();
  rod.velocity().setZero();
  RodStep step(rod);
  const VecX none = VecX::Zero(rod.dofs());
  std::vector<Real> tension, bend;
  ElementState s;
  const auto inner = [&](std::vector<Real>& out) {
    out.clear();
    for (Index e = 10; e < 20; ++e) {
      rod.element_state(e, s);
      for (const Real x : {s.strain, s.twist, s.xa, s.xb}) out.push_back(x);
    }
  };
  inner(tension);
  for (int i = 0; i < 20; ++i) ASSERT_GT(step.advance(rod, 1e-3, Vec3::Zero(), none, 1e-5), 0);
  inner(bend);
  for (std::size_t k = 0; k < bend.size(); ++k) EXPECT_NEAR(bend[k], tension[k], 1e-11);
  EXPECT_LT(rod.elastic_energy(), energy);  // the rest has straightened
  EXPECT_TRUE(rod.release(0));
  EXPECT_FALSE(rod.release(0));
  step.fit(rod);
  EXPECT_GT(step.advance(rod, 1e-3, Vec3::Zero(), none, 1e-5), 0);
  inner(tension);
  Real most = 0;
  for (std::size_t k = 0; k < bend.size(); ++k)
    most = std::max(most, std::abs(bend[k] - tension[k]));
  EXPECT_GT(most, 1e-8);
}

// The matrix is minus the derivative of the balance. At rest under a load, where moments are
// balanced, all of it; and in so long a step, where inertia does not count.
TEST(RigidStretch, TheMatrixIsTheDerivativeOfTheBalance) {
  Rod rod = straight(0.05, 10);
  rod.clamp(0);
  for (Index i = 1; i < rod.nodes(); ++i) {  // a bow, so that arms lie across forces
    const Real s = rod.abscissa()[i] / 0.05;
    rod.poses()[i] = {0.05 * Vec3(std::sin(s), 1 - std::cos(s), 0),
                      Quat(Eigen::AngleAxis<Real>(s, Vec3::UnitZ()))};
  }
  rod.make_rigid({0, 3, 7});
  RodStep step(rod);
  VecX load = VecX::Zero(rod.dofs());
  load.segment<3>(60) = Vec3(2e-4, -3e-4, 1e-4);
  load.segment<3>(30) = Vec3(1e-4, 1e-4, -2e-4);  // on a follower
  step.set_load(load);
  const VecX none = VecX::Zero(rod.dofs());
  const Real dt = 10;
  for (int i = 0; i < 30; ++i) ASSERT_GT(step.advance(rod, dt, Vec3::Zero(), none, 1e-6), 0);
  step.begin(rod, dt, Vec3::Zero());
  step.move_to(rod, none);
  ASSERT_TRUE(step.linearise(rod, none));
  const BlockTridiagonal A = step.matrix();
  ASSERT_EQ(A.blocks(), 7);
  const Real largest = A.diagonal(A.blocks() - 1).cwiseAbs().maxCoeff();
  const Real turn = 1e-5, arm = 5e-3;  // as far as a beam is long
  for (Index node = 1; node < rod.nodes(); ++node) {
    if (rod.stretches().follows(node)) continue;
    for (int d = 0; d < 6; ++d) {
      const Real size = d < 3 ? turn * arm : turn;
      VecX missing[2];
      for (int k = 0; k < 2; ++k) {
        VecX motion = none;
        motion[6 * node + d] = k == 0 ? size : -size;
        step.move_to(rod, motion);
        missing[k] = step.guess().missing;
      }
      VecX x = VecX::Zero(6 * A.blocks()), y(6 * A.blocks());
      x[6 * rod.stretches().block(node) + d] = 1;
      A.multiply(x, y);
      for (Index i = 1; i < rod.nodes(); ++i) {
        if (rod.stretches().follows(i)) continue;
        const Vec6 found = -(missing[0] - missing[1]).segment<6>(6 * i) * dt / (2 * size);
        const Vec6 said = y.segment<6>(6 * rod.stretches().block(i));
        // In units of the largest entry, a force per shift; moments and turns by the arm.
        Vec6 off = (found - said) * (d < 3 ? 1 : 1 / arm);
        off.tail<3>() /= arm;
        EXPECT_LT(off.norm(), 1e-7 * largest) << node << ' ' << d << ' ' << i;
      }
    }
  }
}

TEST(RigidStretch, AMotionOfTheLeaderIsOneOfAll) {
  Rod rod = thrown_and_bent(10, 20);
  VecX motion = VecX::Zero(rod.dofs());
  motion.segment<6>(60) << 0.01, -0.02, 0.005, 2.5, -0.7, 1.1;
  const std::vector<Pose> before = rod.poses();
  std::vector<Pose> after = before;
  std::vector<Real> twist = rod.twist();
  rod.stretches().follow(before, motion);
  move_chain(before, twist, motion, after, twist);
  EXPECT_LT(change_of_shape(before, after, 10, 20), 1e-14);
}

}  // namespace
}  // namespace sutura::thread
