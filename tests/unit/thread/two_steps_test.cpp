// A step that looks back two (rod_history.h), against closed forms of BDF2.
#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "unit/thread/divided_step.h"
#include "unit/thread/rod_builder.h"

namespace sutura::thread {
namespace {

/// A whole step under its weight alone, of the order that is asked for.
void advance(Rod& rod, RodStep& step, Real dt, const Vec3& gravity, Index order) {
  const VecX none = VecX::Zero(rod.dofs());
  step.begin(rod, dt, gravity, order);
  for (int pass = 0; pass < 50; ++pass) {
    ASSERT_TRUE(step.linearise(rod, none));
    step.correct(rod);
    if (step.imbalance(rod, none).relative < 1e-7) break;
  }
  EXPECT_LT(step.imbalance(rod, none).relative, well_balanced);
  step.end(rod, none);
}

/// A straight rod that turns about its middle, at 20 rad/s.
struct Spinning {
  static constexpr Real rate = 20;
  Rod rod;
  RodStep step;
  Spinning() {
    rod.build(straight_layout(0.02, 4, nylon()));
    const Vec3 middle(rod.poses()[2].position);
    for (Index i = 0; i < rod.nodes(); ++i) {
      const Vec3 spin(0, 0, rate);
      rod.velocity().segment<3>(6 * i) = spin.cross(rod.poses()[i].position - middle);
      rod.velocity().segment<3>(6 * i + 3) = spin;
    }
    step.fit(rod);
  }
  Real angle() const {
    const Vec3 chord = rod.poses().back().position - rod.poses().front().position;
    return std::atan2(chord.y(), chord.x());
  }
};

// Nothing turns it faster or slower, so after 0.1 s it has turned by 2 rad. Halving the step makes
// the error half as large one step back and a quarter two steps back. Every third step is half as
// long as the others, so the formula of unequal steps is in it.
TEST(TwoSteps, ASpinningRodIsOfSecondOrderAtUnequalSteps) {
  const auto error = [](Index order, int steps) {
    Spinning s;
    const Real h = 0.1 / steps / 2.5;
    for (int n = 0; n < steps; ++n)
      for (const Real part : {1., 1., 0.5}) advance(s.rod, s.step, part * h, Vec3::Zero(), order);
    return std::abs(s.angle() - 2);
  };
  EXPECT_NEAR(error(2, 20) / error(2, 40), 4, 0.4);
  EXPECT_NEAR(error(1, 20) / error(1, 40), 2, 0.2);
}

// Whatever moves freely keeps its momentum, and gains g t of velocity, at any lengths of steps.
TEST(TwoSteps, AFreeRodKeepsItsMomentumAndFalls) {
  Spinning s;
  const Vec3 gravity(0, 0, -9.81), before = s.rod.momentum();
  const Real mass = s.rod.mass();
  Real time = 0;
  for (const Real h : {0.01, 0.01, 0.005, 0.02, 0.002, 0.01}) {
    advance(s.rod, s.step, h, gravity, 2);
    time += h;
    // Rounding of positions over h, some 1e-17 m / 2 ms, times the mass.
    EXPECT_LT((s.rod.momentum() - before - mass * time * gravity).norm(), 1e-12 * mass);
  }
}

// y' = l y becomes (3/2 - l h) z^2 - 2 z + 1/2 = 0 for the growth z per step. A bending mode of
// frequency w has l = i w, so its amplitude falls by |z| in every step: by far less than the
// 1 / sqrt(1 + (w h)^2) of implicit Euler.
TEST(TwoSteps, AModeDecaysAsItsCharacteristicEquationSays) {
  Rod rod;
  constexpr Real length = 0.05, first_mode = 1.8751040687;  // clamped and free (beta L)
  rod.build(straight_layout(length, 20, nylon()));
  rod.clamp(0);
  const Section s = nylon();
  const Real w = first_mode * first_mode *
                 std::sqrt(s.bending_stiffness() / (s.density * s.area())) / (length * length);
  const Real h = 0.3 / w;
  const std::complex<Real> l(0, w * h);
  const std::complex<Real> z = (2. + std::sqrt(1. + 2. * l)) / (3. - 2. * l);
  // The shape of a cantilever under an even load is within a per cent of that of the first mode;
  // what is left are modes that die within some steps.
  for (Index i = 1; i < rod.nodes(); ++i) {
    const Real x = static_cast<Real>(i) / 20;
    const Real shape = x * x * (6 - 4 * x + x * x) / 3, slope = x * (12 - 12 * x + 4 * x * x) / 3;
    Pose& p = rod.poses()[static_cast<std::size_t>(i)];
    p.position.z() += 1e-7 * shape;
    p.rotation = rotated(p.rotation, Vec3(0, -1e-7 * slope / length, 0));
  }
  RodStep step(rod);
  std::vector<Real> tip;
  for (int n = 0; n < 84; ++n) {
    advance(rod, step, h, Vec3::Zero(), 2);
    tip.push_back(rod.poses().back().position.z());
  }
  // q_{n+2} - a q_{n+1} + b q_n = 0 with a = 2 Re z, b = |z|^2, over a period and more of steps.
  const Real* q = &tip[40];
  const Real det = q[10] * q[10] - q[0] * q[20];
  const Real b = (q[20] * q[20] - q[10] * q[30]) / det;
  EXPECT_NEAR(std::pow(b, 1. / 20), std::abs(z), 1e-3 * std::abs(z));
  EXPECT_GT(std::abs(z), 0.98);
  EXPECT_LT(1 / std::sqrt(1 + w * w * h * h), 0.96);
}

// As with implicit Euler, a step that is begun again forgets the first try.
TEST(TwoSteps, AStepBegunAnewForgetsTheFirstTry) {
  Spinning once, again;
  for (Spinning* s : {&once, &again}) advance(s->rod, s->step, 0.01, Vec3::Zero(), 2);
  again.step.begin(again.rod, 0.004, Vec3::Zero(), 2);
  again.step.begin(again.rod, 0.01, Vec3::Zero(), 1);
  for (Spinning* s : {&once, &again}) advance(s->rod, s->step, 0.01, Vec3::Zero(), 2);
  EXPECT_EQ(once.angle(), again.angle());
  EXPECT_EQ(once.rod.velocity(), again.rod.velocity());
}

}  // namespace
}  // namespace sutura::thread
