// The generic laws, one block at a time.
#include "law_check.h"
#include "sutura/laws/coulomb.h"
#include "sutura/laws/static_friction.h"
#include "sutura/laws/turning_force.h"
#include "sutura/laws/unilateral.h"

using namespace sutura;
using namespace sutura::test;

namespace {

// Rounding: W has condition up to about 1e6 in these draws, so 1e-16 times it with some room.
constexpr Real rounding = 1e-9;

TEST(UnilateralLaw, IsTheOneConsistentCase) {
  std::mt19937_64 random(1);
  for (int i = 0; i < draws; ++i) {
    const Real w = draw_positive(random, -4, 3), d = draw_real(random, -6, 0);
    const Unilateral::Params p{.compliance = i % 2 ? draw_positive(random, -5, 1) : 0};
    Mode mode = 0;
    const Real lambda = project_twice<Unilateral>(BlockMatrix<1>(w), BlockVector<1>(d), p, mode)[0];
    int cases = 0;
    if (d >= 0) {  // open: lambda = 0, delta >= 0
      ++cases;
      EXPECT_EQ(lambda, 0);
      EXPECT_EQ(mode, Unilateral::open);
    }
    if (-d / (w + p.compliance) > 0) {  // closed: delta + c lambda = 0, lambda > 0
      ++cases;
      EXPECT_NEAR(lambda, -d / (w + p.compliance), rounding * lambda);
      EXPECT_EQ(mode, Unilateral::closed);
    }
    ASSERT_EQ(cases, 1);
  }
}

template <int N>
void bilateral_on_its_graph() {
  std::mt19937_64 random(2);
  int capped = 0;
  for (int i = 0; i < draws; ++i) {
    const BlockMatrix<N> W = random_spd<N>(random);
    const BlockVector<N> d = draw_vector<N>(random);
    typename Bilateral<N>::Params p;
    if (i % 2) p.compliance = draw_positive(random, -3, 1);
    if (i % 3) p.cap = draw_positive(random, -3, 1);
    Mode mode = 0;
    const BlockVector<N> lambda = project_twice<Bilateral<N>>(W, d, p, mode);
    const BlockVector<N> delta = W * lambda + d;
    const Real scale = d.norm();
    // Case 1, not at the cap: the linear system, by another factorisation.
    BlockMatrix<N> total = W;
    total.diagonal().array() += p.compliance;
    const BlockVector<N> held = -total.fullPivLu().solve(d);
    if (held.norm() <= p.cap) {
      EXPECT_EQ(mode, Bilateral<N>::holding);
      ASSERT_LT((lambda - held).norm(), rounding * held.norm());
      continue;
    }
    // Case 2, at the cap: |lambda| = cap, delta + c lambda = -s lambda with s >= 0. The problem is
    // strictly convex, so a point that fulfils this is the solution.
    ++capped;
    EXPECT_EQ(mode, Bilateral<N>::capped);
    ASSERT_NEAR(lambda.norm(), p.cap, 1e-12 * p.cap);
    const BlockVector<N> pull = delta + p.compliance * lambda;
    const Real s = -pull.dot(lambda) / lambda.squaredNorm();
    EXPECT_GE(s, -rounding);
    ASSERT_LT((pull + s * lambda).norm(), 1e-8 * scale);
  }
  EXPECT_GT(capped, draws / 10);
}
TEST(BilateralLaw, OneRow) {
  bilateral_on_its_graph<1>();
}
TEST(BilateralLaw, TwoRows) {
  bilateral_on_its_graph<2>();
}
TEST(BilateralLaw, ThreeRows) {
  bilateral_on_its_graph<3>();
}
TEST(BilateralLaw, SixRows) {
  bilateral_on_its_graph<6>();
}

TEST(BilateralLaw, RepeatedRowsGiveTheSmallestForce) {
  // Two rows that say the same: W singular. Least norm of all lambda with lambda_1 + lambda_2 = -1.
  BlockMatrix<2> W;
  W << 1, 1, 1, 1;
  Mode mode = 0;
  Vec2 lambda = Vec2::Zero();
  Bilateral<2>::project(W, Vec2(1, 1), {.cap = 10}, mode, lambda);
  EXPECT_NEAR(lambda.sum(), -1, 1e-12);
  EXPECT_LT((lambda - Vec2(-0.5, -0.5)).norm(), 1e-12);
}

TEST(BilateralLaw, ContinuousAtTheCap) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 1000; ++i) {
    const Mat3 W = random_spd<3>(random);
    const Vec3 d = draw_vector<3>(random);
    const Vec3 held = -W.fullPivLu().solve(d);
    Vec3 below, above;
    Mode mode = 0;
    const Real eps = 1e-7;
    Bilateral<3>::project(W, d, {.cap = held.norm() * (1 + eps)}, mode, below);
    Bilateral<3>::project(W, d, {.cap = held.norm() * (1 - eps)}, mode, above);
    // The cap moves by 2 eps; the force turns at most with the condition of W, bounded in these
    // draws by about 1e5.
    EXPECT_LT((below - above).norm(), 1e5 * eps * held.norm());
    EXPECT_LT(std::abs(below.norm() - above.norm()), 3 * eps * held.norm());
  }
}

// As a whole it is one linear system, as a spring one row; both by another factorisation.
TEST(TurningForceLaw, IsTheSolutionOfItsTwoRows) {
  std::mt19937_64 random(12);
  int silent = 0;
  for (int i = 0; i < draws; ++i) {
    const BlockMatrix<2> W = random_spd<2>(random);
    const BlockVector<2> d = draw_vector<2>(random);
    const TurningForce::Params p{.stiffness = draw_real(random, -3, 1) * (i % 3 ? 1 : -1),
                                 .coupling = draw_positive(random, -3, 1)};
    Mode mode = TurningForce::whole;
    BlockVector<2> lambda = project_twice<TurningForce>(W, d, p, mode);
    EXPECT_EQ(mode, TurningForce::whole);
    // lambda = -K delta, delta = W lambda + d:  (1 + K W) lambda = -K d.
    BlockMatrix<2> K;
    K << p.stiffness, p.coupling, p.coupling, 0;
    const BlockMatrix<2> M = BlockMatrix<2>::Identity() + K * W;
    ASSERT_LT((M * lambda + K * d).norm(), rounding * M.norm() * (lambda.norm() + K.norm()));

    mode = TurningForce::spring;
    lambda = project_twice<TurningForce>(W, d, p, mode);
    EXPECT_EQ(mode, TurningForce::spring);
    EXPECT_EQ(lambda[1], 0);
    if (p.stiffness > 0) {
      const Real delta = W(0, 0) * lambda[0] + d[0];
      ASSERT_NEAR(lambda[0], -p.stiffness * delta, rounding * std::abs(lambda[0]));
    } else {
      ++silent;
      EXPECT_EQ(lambda[0], 0);
    }
  }
  EXPECT_GT(silent, draws / 10);
}

/// All solutions of one frictional contact with normal force at most cap, by cases. Slip directions
/// are found by scanning the angle and bisection, unlike the law, which scans a compliance.
std::vector<Vec3> coulomb_solutions(const Mat3& W, const Vec3& d, Real mu) {
  std::vector<Vec3> found;
  if (d[0] >= 0) found.push_back(Vec3::Zero());
  const Vec3 stick = -W.fullPivLu().solve(d);
  if (stick[0] > 0 && stick.tail<2>().norm() <= mu * stick[0]) found.push_back(stick);
  const auto slip = [&](Real angle, Vec3& lambda) {
    const Vec3 ray(1, -mu * std::cos(angle), -mu * std::sin(angle));
    const Real w = W.row(0).dot(ray);
    lambda = -d[0] / w * ray;
    const Vec3 delta = W * lambda + d;
    return delta[2] * std::cos(angle) - delta[1] * std::sin(angle);
  };
  constexpr int angles = 360;
  Vec3 lambda;
  Real before = slip(0, lambda);
  for (int i = 1; i <= angles; ++i) {
    Real low = 2 * M_PI * (i - 1) / angles, high = 2 * M_PI * i / angles;
    const Real here = slip(high, lambda);
    if ((before > 0) != (here > 0)) {
      const bool rising = here > 0;
      for (int k = 0; k < 60; ++k) {
        const Real middle = 0.5 * (low + high);
        ((slip(middle, lambda) > 0) == rising ? high : low) = middle;
      }
      const Real residual = slip(high, lambda);
      const Vec3 delta = W * lambda + d;
      const bool opposes = delta[1] * std::cos(high) + delta[2] * std::sin(high) >= 0;
      // A pole of lambda_n(angle) changes sign too, but is no solution.
      if (lambda[0] > 0 && opposes && std::abs(residual) < 1e-6 * (d.norm() + 1))
        found.push_back(lambda);
    }
    before = here;
  }
  return found;
}

TEST(CoulombLaw, IsOneOfTheEnumeratedSolutions) {
  std::mt19937_64 random(4);
  int states[3] = {}, several = 0, missed = 0;
  for (int i = 0; i < draws; ++i) {
    const Mat3 W = random_spd<3>(random);
    const Vec3 d = draw_vector<3>(random);
    const Coulomb::Params p{.mu = i % 10 ? draw_positive(random, -2, 0) : 0};
    Mode mode = 0;
    const Vec3 lambda = project_twice<Coulomb>(W, d, p, mode);
    ++states[mode];
    // On the graph, exactly:
    const Vec3 delta = W * lambda + d;
    const Real scale = 1e-8 * d.norm();
    const Real t = lambda.tail<2>().norm();
    ASSERT_GE(lambda[0], 0);
    ASSERT_LE(t, p.mu * lambda[0] * (1 + 1e-12));
    if (lambda[0] > 0) {
      ASSERT_LT(std::abs(delta[0]), scale);
    } else {
      ASSERT_GE(delta[0], 0);
    }
    if (mode == static_cast<Mode>(Friction::stick)) {
      ASSERT_LT(delta.norm(), scale);
    }
    if (mode == static_cast<Mode>(Friction::slip) && t > 0) {
      ASSERT_LT((delta.tail<2>() / delta.tail<2>().norm() + lambda.tail<2>() / t).norm() *
                    delta.tail<2>().norm(),
                scale * 10);
    }
    // And one of those that the other route finds.
    if (i % 10) {
      const auto all = coulomb_solutions(W, d, p.mu);
      if (all.size() > 1) ++several;
      Real nearest = 1e300;
      for (const Vec3& other : all) nearest = std::min(nearest, (W * (other - lambda)).norm());
      // The scan can miss a pair of roots within one degree, not more.
      if (nearest > 1e-5 * d.norm()) ++missed;
    }
  }
  EXPECT_GT(states[0], draws / 10);
  EXPECT_GT(states[1], draws / 100);
  EXPECT_GT(states[2], draws / 10);
  EXPECT_LT(several, draws / 10);
  EXPECT_LT(missed, draws / 1000);
}

// In each of its two levels it is Coulomb's law, which is enumerated above; only an event changes
// the level within a step, and only from rest to sliding.
TEST(StaticFrictionLaw, IsCoulombsInEachLevel) {
  std::mt19937_64 random(11);
  int broke_away = 0, held_between = 0;
  for (int i = 0; i < draws; ++i) {
    const Mat3 W = random_spd<3>(random);
    const Vec3 d = draw_vector<3>(random);
    const StaticFriction::Params p{
        .mu_static = 0.6, .mu_kinetic = 0.3, .compliance = i % 2 ? 0.1 : 0., .stick_slip = 1e-3};
    Mode rest = 0, slide = StaticFriction::sliding;
    const Vec3 at_rest = project_twice<StaticFriction>(W, d, p, rest);
    const Vec3 sliding = project_twice<StaticFriction>(W, d, p, slide);
    Mode mode = 0;
    EXPECT_EQ(at_rest, project_twice<Coulomb>(W, d, {0.6, p.compliance}, mode));
    EXPECT_EQ(rest, mode);
    EXPECT_EQ(sliding, project_twice<Coulomb>(W, d, {0.3, p.compliance}, mode));
    EXPECT_EQ(slide, mode | StaticFriction::sliding);
    const Vec3 delta = W * at_rest + d;
    const Real slip = delta.tail<2>().norm();
    const bool slips = mode == static_cast<Mode>(Friction::slip);
    Mode after = rest;
    const bool event = StaticFriction::event(p, delta, after, at_rest);
    EXPECT_EQ(event, rest == static_cast<Mode>(Friction::slip) && slip > p.stick_slip);
    EXPECT_EQ(after, event ? (rest | StaticFriction::sliding) : rest);
    EXPECT_FALSE(StaticFriction::event(p, delta, after, at_rest)) << "once";
    broke_away += event;
    held_between += slips && rest == static_cast<Mode>(Friction::stick);
    // Sliding on, or back to rest.
    const Vec3 moved = W * sliding + d;
    const Mode next = StaticFriction::next_mode(p, moved, slide, sliding);
    EXPECT_EQ((next & StaticFriction::sliding) != 0,
              slips && moved.tail<2>().norm() > p.stick_slip);
  }
  EXPECT_GT(broke_away, draws / 100);
  EXPECT_GT(held_between, draws / 100);
}

TEST(CoulombLaw, TangentIsFirstOrderExact) {
  // Halving the step along the tangent halves the error relative to the step: ratio 2 for a true
  // tangent, 1 for a wrong one. The median over draws, since a step may cross into another case.
  std::mt19937_64 random(5);
  std::vector<Real> ratio;
  for (int i = 0; i < 2000; ++i) {
    const Mat3 W = random_spd<3>(random);
    const Vec3 d = draw_vector<3>(random);
    const Coulomb::Params p{.mu = 0.3, .compliance = i % 2 ? 0.2 : 0.0};
    Mode mode = 0;
    Vec3 lambda;
    Coulomb::project(W, d, p, mode, lambda);
    if (mode != static_cast<Mode>(Friction::slip)) continue;
    std::mt19937_64 same_a(6), same_b(6);
    const Real coarse = tangent_error<Coulomb>(W, d, p, mode, lambda, 1e-3 * lambda.norm(), same_a);
    const Real fine = tangent_error<Coulomb>(W, d, p, mode, lambda, 0.5e-3 * lambda.norm(), same_b);
    ratio.push_back(coarse / fine);
  }
  ASSERT_GT(ratio.size(), 300u);
  std::nth_element(ratio.begin(), ratio.begin() + static_cast<long>(ratio.size() / 2), ratio.end());
  EXPECT_NEAR(ratio[ratio.size() / 2], 2, 0.1);
}

TEST(CoulombLaw, ContinuousWhereItOpensAndSlips) {
  const Mat3 W = Vec3(1, 2, 3).asDiagonal();
  const Coulomb::Params p{.mu = 0.5};
  Mode mode = 0;
  Vec3 a, b;
  const Real eps = 1e-9;
  // Opens at d_n = 0.
  Coulomb::project(W, Vec3(-eps, 0.1, 0), p, mode, a);
  Coulomb::project(W, Vec3(eps, 0.1, 0), p, mode, b);
  EXPECT_LT((a - b).norm(), 2 * eps);
  // Slips at |d_t| / 2 = mu * 1.
  Coulomb::project(W, Vec3(-1, 1 - eps, 0), p, mode, a);
  EXPECT_EQ(mode, static_cast<Mode>(Friction::stick));
  Coulomb::project(W, Vec3(-1, 1 + eps, 0), p, mode, b);
  EXPECT_EQ(mode, static_cast<Mode>(Friction::slip));
  EXPECT_LT((a - b).norm(), 2 * eps);
}

}  // namespace
