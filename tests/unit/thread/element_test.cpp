#include "element.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "rod.h"
#include "rod_builder.h"

namespace sutura::thread {
namespace {

struct Random {
  std::mt19937 engine{7};
  std::uniform_real_distribution<Real> uniform{-1, 1};
  Vec3 vector() { return {uniform(engine), uniform(engine), uniform(engine)}; }
};

/// Ends of a beam bent by about `angle` and twisted by `twist`, in a random attitude.
struct BentBeam {
  ElementRest rest;
  Pose a, b;
  Real twist;
  BentBeam(Random& random, bool curved, Real angle, Real twist_, Real stretch)
      : rest(make_rest(curved)), twist(twist_) {
    const Quat attitude(Quat::UnitRandom());
    const Real L = rest.length;
    a.position = 0.1 * random.vector();
    b.position = a.position + L * (1 + stretch) * (attitude * Vec3::UnitX());
    a.rotation = rotated(attitude * rest.frame_a.conjugate(),
                         attitude * Vec3(0, angle * random.uniform(random.engine), angle));
    const Quat roll(Eigen::AngleAxis<Real>(twist, Vec3::UnitX()));
    b.rotation = rotated(attitude * roll * rest.frame_b.conjugate(),
                         attitude * Vec3(0, angle, -angle * random.uniform(random.engine)));
  }
  static ElementRest make_rest(bool curved) {
    Pose a, b;
    const Real L = 2e-3;
    b.position = Vec3(L, 0, 0);
    if (curved) {  // an arc of 0.6 rad
      const Real r = L / 0.6;
      b.position = Vec3(r * std::sin(0.6), r * (1 - std::cos(0.6)), 0);
      b.rotation = Quat(Eigen::AngleAxis<Real>(0.6, Vec3::UnitZ()));
    }
    return {a, b, L, nylon()};
  }
  void moved(const Vec9& d, Pose& ma, Pose& mb) const {
    ma = a;
    mb = b;
    mb.position += d.head<3>();
    ma.rotation = rotated(a.rotation, d.segment<3>(3));
    mb.rotation = rotated(b.rotation, d.tail<3>());
  }
  Real energy(const Vec9& d) const {
    Pose ma, mb;
    moved(d, ma, mb);
    ElementState s;
    evaluate(rest, ma, mb, twist, s);
    return elastic_energy(rest, s);
  }
  Vec9 slope(const Vec9& d) const {
    Pose ma, mb;
    moved(d, ma, mb);
    ElementState s;
    evaluate(rest, ma, mb, twist, s);
    const ElementGradient g = gradient(rest, s);
    Vec9 v;
    v << g.v, g.a, g.b;
    return v;
  }
};

/// A stiffness over shifts in beam lengths, so that all of it is in N m.
Mat12 in_radians(const Mat12& k, Real length) {
  Eigen::Matrix<Real, 12, 1> scale;
  scale << Vec3::Constant(length), Vec3::Ones(), Vec3::Constant(length), Vec3::Ones();
  return scale.asDiagonal() * k * scale.asDiagonal();
}

struct Case {
  bool curved;
  Real angle, twist, stretch;
};
class Element : public testing::TestWithParam<Case> {};

// Central differences of step d have a relative error of (d/scale)^2 + 1e-16 scale/d: with d/scale
// = 1e-5, 1e-10 + 1e-11, times the cancellation between terms of the energy (axial against bending,
// about 1e2).
constexpr Real tolerance = 1e-7;

TEST_P(Element, ForceIsTheGradientOfTheEnergy) {
  Random random;
  const Case c = GetParam();
  const BentBeam beam(random, c.curved, c.angle, c.twist, c.stretch);
  const Vec9 g = beam.slope(Vec9::Zero());
  Vec9 difference;
  for (int i = 0; i < 9; ++i) {
    const Real step = 1e-5 * (i < 3 ? beam.rest.length : 1);
    Vec9 d = Vec9::Zero();
    d[i] = step;
    difference[i] = (beam.energy(d) - beam.energy(-d)) / (2 * step);
  }
  // Forces and moments have their own scale.
  const Real force = g.head<3>().norm();
  const Real moment = g.tail<6>().norm() + force * beam.rest.length;
  EXPECT_LT((difference - g).head<3>().norm(), tolerance * force);
  EXPECT_LT((difference - g).tail<6>().norm(), tolerance * moment);
}

TEST_P(Element, HessianIsTheDerivativeOfTheForce) {
  Random random;
  const Case c = GetParam();
  const BentBeam beam(random, c.curved, c.angle, c.twist, c.stretch);
  ElementState s;
  evaluate(beam.rest, beam.a, beam.b, beam.twist, s);
  Mat9 k;
  hessian(beam.rest, s, k);
  EXPECT_LT((k - k.transpose()).norm(), 1e-12 * k.norm());
  ElementMatrix parts;
  hessian(beam.rest, s, parts);
  EXPECT_EQ(expand(parts), expand(k));
  // The gradient in spins is not a gradient in rotation vectors: its derivative along a constant
  // spin is the symmetric Hessian plus half the bracket of the moments, an antisymmetric part.
  Mat9 expected = Mat9::Zero();
  for (int i = 0; i < 9; ++i) {
    const Real step = 1e-5 * (i < 3 ? beam.rest.length : 1);
    Vec9 d = Vec9::Zero();
    d[i] = step;
    expected.col(i) = (beam.slope(d) - beam.slope(-d)) / (2 * step);
  }
  expected = ((expected + expected.transpose()) / 2).eval();
  Vec9 scale;
  scale << Vec3::Constant(beam.rest.length), Vec6::Ones();
  const Mat9 scaled = scale.asDiagonal() * k * scale.asDiagonal();
  const Mat9 error = scale.asDiagonal() * (expected - k) * scale.asDiagonal();
  EXPECT_LT(error.norm(), tolerance * scaled.norm());
}

TEST_P(Element, StepStiffnessIsPositive) {
  Random random;
  const Case c = GetParam();
  const BentBeam beam(random, c.curved, c.angle, c.twist, c.stretch);
  ElementState s;
  evaluate(beam.rest, beam.a, beam.b, beam.twist, s);
  ElementMatrix k;
  step_stiffness(beam.rest, s, std::max(s.tension, 0.), 1, k);
  const Mat12 full = in_radians(expand(k), beam.rest.length);
  const Eigen::SelfAdjointEigenSolver<Mat12> eigen(full);
  EXPECT_GT(eigen.eigenvalues().minCoeff(), -1e-12 * eigen.eigenvalues().maxCoeff());
}

TEST_P(Element, StepStiffnessHasAllOfTheStretch) {
  // Without tension the two differ in the moments of bending and twist only: their size is that of
  // EI/L and GJ/L, times a few radians. EA L is a thousand times more: a share of it that is left
  // out of one motion, as of a roll about the chord, shows.
  Random random;
  const Case c = GetParam();
  const BentBeam beam(random, c.curved, c.angle, c.twist, c.stretch);
  ElementState s;
  evaluate(beam.rest, beam.a, beam.b, beam.twist, s);
  s.tension = 0;
  ElementMatrix k;
  step_stiffness(beam.rest, s, 0, 1, k);
  Mat9 h;
  hessian(beam.rest, s, h);
  const Mat12 error = in_radians(expand(k) - expand(h), beam.rest.length);
  const Real twist = 1 + std::abs(c.twist), bend = 1 + c.angle;
  EXPECT_LT(error.norm(), 10 * bend * (beam.rest.bend_1 + twist * beam.rest.torsion));
}

TEST(TautElement, ResistsARollThatTurnsItsTiltsApart) {
  // Both ends tilted by theta to the same side of a chord under tension N. The bow's energy has the
  // term -N L/30 theta^2 cos(roll) for a roll of one end about the chord: N L/30 theta^2 is the
  // exact stiffness. The convex one takes the roll for two tilts aside by theta/2 each, of opposite
  // sign: (c1 - c2) theta^2/2 = 2.5 times that. What else resists is a hundredth of it here.
  const ElementRest rest = BentBeam::make_rest(false);
  const Real theta = 0.1;
  Pose a, b;
  b.position = Vec3(rest.length, 0, 0);
  a.rotation = b.rotation = Quat(Eigen::AngleAxis<Real>(theta, Vec3::UnitZ()));
  ElementState s;
  evaluate(rest, a, b, 0, s);
  s.tension = 100 * (rest.bend_1 + rest.torsion) / rest.length / (theta * theta) * 30;
  ElementMatrix k;
  step_stiffness(rest, s, s.tension, 1, k);
  Mat9 h;
  hessian(rest, s, h);
  const Real exact = s.tension * rest.length / 30 * theta * theta;
  EXPECT_NEAR(h(3, 3), exact, 0.05 * exact);
  EXPECT_NEAR(k.aa(0, 0), 2.5 * exact, 0.05 * 2.5 * exact);
}

TEST(BentElement, TheRollOfTheChordSaysWhichOfTwoRollsCostsNothing) {
  // Tilted by theta and -theta: a bow. The exact energy does not change if all of it rolls about
  // the chord, nor if each end rolls about its own axis. In the convex form the chord takes a share
  // s of the roll, and the tilts move aside by (1 - s) theta in the first motion and by s theta in
  // the second: 2 (c1 - c2) theta^2 times (1 - s)^2 and s^2.
  const ElementRest rest = BentBeam::make_rest(false);
  const Real theta = 0.1;
  Pose a, b;
  b.position = Vec3(rest.length, 0, 0);
  a.rotation = Quat(Eigen::AngleAxis<Real>(theta, Vec3::UnitZ()));
  b.rotation = Quat(Eigen::AngleAxis<Real>(-theta, Vec3::UnitZ()));
  ElementState s;
  evaluate(rest, a, b, 0, s);
  s.tension = 0;
  const Real aside = 2 * (rest.bend_1 - rest.bend_2) * theta * theta;
  for (const Real share : {0., 0.3, 1.}) {
    ElementMatrix k;
    step_stiffness(rest, s, 0, share, k);
    const auto energy = [&k](const Vec3& first, const Vec3& second) {
      return first.dot(k.aa * first) + 2 * first.dot(k.ab * second) + second.dot(k.bb * second);
    };
    // Of the tilts squared, a hundredth is left out here.
    EXPECT_NEAR(energy(s.e, s.e), (1 - share) * (1 - share) * aside, 0.02 * aside);
    EXPECT_NEAR(energy(s.ca, s.cb), share * share * aside, 0.02 * aside);
  }
}

INSTANTIATE_TEST_SUITE_P(States, Element,
                         testing::Values(Case{false, 0, 0, 0.01}, Case{false, 0.1, 0.3, 1e-3},
                                         Case{false, 0.6, 2.5, 1e-3}, Case{false, 0.4, 9.0, -1e-3},
                                         Case{false, 1.2, -1.0, 0.05}, Case{true, 0.1, 0.2, 1e-3},
                                         Case{true, 0.5, -2.0, 1e-2}));

TEST(ElementAtRest, StiffnessesAgree) {
  // At rest the moments vanish and the time step's stiffness is the Hessian.
  for (const bool curved : {false, true}) {
    Random random;
    const BentBeam beam(random, curved, 0, 0, 0);
    const ElementRest rest = BentBeam::make_rest(curved);
    Pose a, b;
    b.position = Vec3(2e-3, 0, 0);
    if (curved) {
      const Real r = 2e-3 / 0.6;
      b.position = Vec3(r * std::sin(0.6), r * (1 - std::cos(0.6)), 0);
      b.rotation = Quat(Eigen::AngleAxis<Real>(0.6, Vec3::UnitZ()));
    }
    ElementState s;
    evaluate(rest, a, b, 0, s);
    // Rounding of the chord times EA.
    EXPECT_LT(gradient(rest, s).v.norm(), 1e-14 * rest.axial);
    ElementMatrix k;
    step_stiffness(rest, s, s.tension, 1, k);
    Mat9 h;
    hessian(rest, s, h);
    const Mat12 full = expand(k);
    EXPECT_LT((full - expand(h)).norm(), 1e-12 * full.norm()) << curved;
  }
}

TEST(ElementAtRest, RigidMotionCostsNothing) {
  for (const bool curved : {false, true}) {
    const ElementRest rest = BentBeam::make_rest(curved);
    Pose a, b;
    b.position = Vec3(2e-3, 0, 0);
    if (curved) {
      const Real r = 2e-3 / 0.6;
      b.position = Vec3(r * std::sin(0.6), r * (1 - std::cos(0.6)), 0);
      b.rotation = Quat(Eigen::AngleAxis<Real>(0.6, Vec3::UnitZ()));
    }
    const Quat q = Quat::UnitRandom();
    const Pose ma{q * a.position + Vec3(1, 2, 3), q * a.rotation};
    const Pose mb{q * b.position + Vec3(1, 2, 3), q * b.rotation};
    ElementState s;
    evaluate(rest, ma, mb, 0, s);
    // Positions near 4 m carry rounding of 1e-15 m over 2 mm: strain 1e-12, energy its square.
    EXPECT_LT(elastic_energy(rest, s), 1e-22 * rest.axial * rest.length);
  }
}

TEST(ElementTwist, CountsTurns) {
  const ElementRest rest = BentBeam::make_rest(false);
  Pose a, b;
  b.position = Vec3(2e-3, 0, 0);
  Real twist = 0;
  ElementState s;
  for (int i = 0; i < 100; ++i) {  // 20 rad in steps of 0.2
    b.rotation = rotated(b.rotation, Vec3(0.2, 0, 0));
    evaluate(rest, a, b, twist, s);
    twist = s.twist;
  }
  EXPECT_NEAR(twist, 20, 1e-12);
}

TEST(ElementMass, TotalsAreThoseOfTheBeam) {
  const ElementRest rest = BentBeam::make_rest(true);
  const ElementMass m(rest);
  const Vec3 e = Vec3::UnitX();
  const Vec3 ta = Vec3(1, -0.2, 0).normalized(), tb = Vec3(1, 0.3, 0.1).normalized();
  const Mat12 k = mass_matrix(m, e, ta, tb);
  Eigen::Matrix<Real, 12, 3> shift = Eigen::Matrix<Real, 12, 3>::Zero();
  shift.topRows<3>().setIdentity();
  shift.middleRows<3>(6).setIdentity();
  const Mat3 total = shift.transpose() * k * shift;
  EXPECT_LT((total - rest.mass * Mat3::Identity()).norm(), 1e-14 * rest.mass);
  const Eigen::SelfAdjointEigenSolver<Mat12> eigen(k);
  EXPECT_GT(eigen.eigenvalues().minCoeff(), 0);
}

}  // namespace
}  // namespace sutura::thread
