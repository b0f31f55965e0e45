#include "viscosity.h"

#include <gtest/gtest.h>

#include <random>

#include "rod_builder.h"
#include "rod_step.h"
#include "rod_tangent.h"

namespace sutura::thread {
namespace {

/// Two poses of a beam and its twist, moved by (v of b, spin of a, spin of b).
struct Beam {
  Pose a, b;
  Real twist = 0;
  Beam moved(const Vec9& d) const {
    Beam m = *this;
    m.b.position += d.head<3>();
    m.a.rotation = rotated(a.rotation, d.segment<3>(3));
    m.b.rotation = rotated(b.rotation, d.tail<3>());
    return m;
  }
  ElementState state(const ElementRest& rest) const {
    ElementState s;
    evaluate(rest, a, b, twist, s);
    return s;
  }
};

/// A beam bent by tenths of a radian and twisted, and how it was before a step that turned it by
/// about a radian and deformed it further.
struct Step {
  ElementRest rest;
  Beam start, end;
  explicit Step(bool curved) : rest(make_rest(curved)) {
    std::mt19937 engine(5);
    std::uniform_real_distribution<Real> uniform(-1, 1);
    const auto vector = [&] { return Vec3(uniform(engine), uniform(engine), uniform(engine)); };
    start.b.position = rest.length * Vec3(1.01, 0.1, -0.05);
    start.a.rotation = rotated(rest.frame_a.conjugate(), 0.3 * vector());
    start.b.rotation = rotated(rest.frame_b.conjugate(), 0.3 * vector());
    start.twist = start.state(rest).twist;
    Vec9 change;
    change << 0.05 * rest.length * vector(), 0.2 * vector(), 0.2 * vector();
    end = rigid(start.moved(change), vector());
    end.twist = end.state(rest).twist;
  }
  static ElementRest make_rest(bool curved) {
    Pose a, b;
    b.position = Vec3(2e-3, 0, 0);
    if (curved) b.rotation = Quat(Eigen::AngleAxis<Real>(0.5, Vec3::UnitZ()));
    return {a, b, 2e-3, nylon()};
  }
  /// The beam turned about the origin and shifted.
  static Beam rigid(const Beam& beam, const Vec3& turn) {
    Beam m = beam;
    const Quat q = rotated(Quat::Identity(), turn);
    for (Pose* p : {&m.a, &m.b}) {
      p->position = q * p->position + Vec3(1e-3, -2e-3, 3e-3);
      p->rotation = q * p->rotation;
    }
    return m;
  }
  DeformationChange change(const Beam& now) const {
    return {now.state(rest), now.a, now.b, Deformation(start.state(rest), start.a, start.b)};
  }
};

class Viscosity : public testing::TestWithParam<bool> {};

TEST_P(Viscosity, ForceIsTheGradientOfWhatIsDissipated) {
  const Step step(GetParam());
  const ElementState s = step.end.state(step.rest);
  const ElementGradient g = viscous_gradient(step.rest, s, step.change(step.end));
  Vec9 slope, gradient;
  gradient << g.v, g.a, g.b;
  for (int i = 0; i < 9; ++i) {
    const Real size = 1e-5 * (i < 3 ? step.rest.length : 1);
    const auto energy = [&](Real way) {
      return viscous_energy(step.rest, step.change(step.end.moved(way * size * Vec9::Unit(i))));
    };
    slope[i] = (energy(1) - energy(-1)) / (2 * size);
  }
  // Central differences, as in element_test.cpp.
  const Real force = gradient.head<3>().norm();
  const Real moment = gradient.tail<6>().norm() + force * step.rest.length;
  EXPECT_LT((slope - gradient).head<3>().norm(), 1e-7 * force);
  EXPECT_LT((slope - gradient).tail<6>().norm(), 1e-7 * moment);
}

TEST_P(Viscosity, ARigidMotionDissipatesNothing) {
  const Step step(GetParam());
  Beam turned = Step::rigid(step.start, Vec3(1.2, -0.7, 2.1));
  turned.twist = step.start.twist;
  const DeformationChange none = step.change(turned);
  // Rounding of coordinates of the size of the beam, against its length.
  EXPECT_LT(std::abs(none.strain), 1e-13);
  EXPECT_LT(std::abs(none.twist), 1e-13);
  EXPECT_LT(none.bend_a.norm() + none.bend_b.norm(), 1e-13);
}

INSTANTIATE_TEST_SUITE_P(StraightAndCurved, Viscosity, testing::Bool());

// A straight rod that a step presses together has tension but no moments: there the exact matrix of
// the step is minus the derivative of the balance by the velocity, with all of the viscous force,
// which pushes sideways like any compression.
TEST(Viscosity, HasItsCompressionInTheMatrix) {
  constexpr Index beams = 3;
  Rod rod;
  rod.build(straight_layout(0.01, beams, nylon()));
  RodStart start;
  start.resize(rod.nodes());
  start.dt = 1e-3;
  start.damping = {.mass = 2, .stiffness = 5e-3};
  rod.mark_start();
  start.twist = rod.twist();
  start.take(rod, true);
  RodGuess guess;
  guess.resize(rod.nodes());
  const auto moved = [&](const VecX& motion) {
    guess.motion = motion;
    guess.move(rod, start);
    return VecX(guess.missing);
  };
  VecX motion = VecX::Zero(rod.dofs());
  for (Index i = 0; i < rod.nodes(); ++i) motion[6 * i] = -1e-2 * rod.poses()[i].position.x();
  moved(motion);
  guess.take_tension();
  ASSERT_LT(guess.tension[0], 0);
  BlockTridiagonal A;
  A.resize(rod.nodes());
  assemble(rod, start, guess, Tangent::exact, A);
  MatX full = MatX::Zero(rod.dofs(), rod.dofs());
  for (Index i = 0; i < rod.nodes(); ++i) {
    full.block<6, 6>(6 * i, 6 * i) = A.diagonal(i);
    if (i == beams) break;
    full.block<6, 6>(6 * i, 6 * i + 6) = A.upper(i);
    full.block<6, 6>(6 * i + 6, 6 * i) = A.upper(i).transpose();
  }
  VecX scale(rod.dofs());  // so that all of it is in the units of a spin
  for (Index i = 0; i < rod.nodes(); ++i)
    scale.segment<6>(6 * i) << Vec3::Constant(0.01 / beams), Vec3::Ones();
  const MatX scaled = scale.asDiagonal() * full * scale.asDiagonal();
  MatX slope(rod.dofs(), rod.dofs());
  for (Index j = 0; j < rod.dofs(); ++j) {
    const VecX step = 1e-5 * scale[j] * VecX::Unit(rod.dofs(), j);
    slope.col(j) = start.dt * (moved(motion - step) - moved(motion + step)) / (2e-5 * scale[j]);
  }
  const MatX error =
      scale.asDiagonal() * MatX((slope + slope.transpose()) / 2) * scale.asDiagonal() - scaled;
  // Across the chord the compression of viscosity alone is 1e-2 of the largest entry; central
  // differences leave 1e-9.
  EXPECT_LT(error.norm(), 1e-6 * scaled.norm());
}

// A rod in space that spins about an axis across it. Its own strain, of the centrifugal force
// m w^2 r, is 5e-7; K v would add beta/h times the stretch of the turn in a step, (w h)^2/2 = 1e-2.
TEST(Viscosity, LeavesASpinningRodAlone) {
  constexpr Real spin = 15, length = 0.05;
  Rod rod;
  rod.build(straight_layout(length, 20, nylon()));
  RodStep step(rod);
  step.damping.stiffness = 10e-3;
  const Vec3 middle = rod.poses(Configuration::current)[10].position;
  for (Index i = 0; i < rod.nodes(); ++i) {
    const Vec3 arm = rod.poses(Configuration::current)[i].position - middle;
    rod.velocity().segment<3>(6 * i) = Vec3(0, 0, spin).cross(arm);
    rod.velocity().segment<3>(6 * i + 3) = Vec3(0, 0, spin);
  }
  const Real density = rod.mass() / length / rod.section(0).axial_stiffness();
  const Real centrifugal = density * spin * spin * length * length / 8;
  for (int i = 0; i < 10; ++i) {
    // A hundredth of the centrifugal force.
    ASSERT_GT(step.advance(rod, 0.01, Vec3::Zero(), VecX::Zero(rod.dofs()), 0.01), 0);
    for (Index e = 0; e < rod.beams(); ++e) {
      ElementState s;
      rod.element_state(e, s);
      ASSERT_LT(std::abs(s.strain), 2 * centrifugal) << i;
    }
  }
}

}  // namespace
}  // namespace sutura::thread
