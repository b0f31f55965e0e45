// The laws of suturing, one block at a time, against enumeration of their cases.
#include "cutting_law.h"
#include "path_friction_law.h"
#include "puncture_law.h"
#include "unit/solve/law_check.h"

using namespace sutura;
using namespace sutura::suturing;
using namespace sutura::test;

namespace {

TEST(CuttingLaw, IsTheOneConsistentCase) {
  std::mt19937_64 random(1);
  for (int i = 0; i < draws; ++i) {
    const Real w = draw_positive(random, -4, 3), d = draw_real(random, -6, 0);
    const CuttingLaw::Params p{.threshold = draw_positive(random, -3, 1)};
    Mode mode = 0;
    const Real lambda = project_twice<CuttingLaw>(BlockMatrix<1>(w), BlockVector<1>(d), p, mode)[0];
    int cases = 0;
    if (d > 0) {
      ++cases;
      EXPECT_EQ(lambda, 0);
      EXPECT_EQ(mode, CuttingLaw::behind);
    }
    const Real stop = -d / w;
    if (stop > 0 && stop < p.threshold) {
      ++cases;
      EXPECT_NEAR(lambda, stop, 1e-12 * stop);
      EXPECT_EQ(mode, CuttingLaw::stopped);
    }
    if (d + w * p.threshold < 0) {
      ++cases;
      EXPECT_EQ(lambda, p.threshold);
      EXPECT_EQ(mode, CuttingLaw::cutting);
    }
    ASSERT_EQ(cases, 1);
  }
}

TEST(CuttingLaw, ContinuousAtItsThresholds) {
  const CuttingLaw::Params p{.threshold = 0.4};
  const BlockMatrix<1> w(0.01);
  for (const Real d : {0.0, -0.01 * 0.4}) {
    BlockVector<1> a, b;
    Mode mode = 0;
    CuttingLaw::project(w, BlockVector<1>(d - 1e-12), p, mode, a);
    CuttingLaw::project(w, BlockVector<1>(d + 1e-12), p, mode, b);
    EXPECT_NEAR(a[0], b[0], 2.1e-12 / 0.01);
  }
}

TEST(PathFrictionLaw, IsTheOneConsistentCase) {
  std::mt19937_64 random(2);
  for (int i = 0; i < draws; ++i) {
    const Real w = draw_positive(random, -4, 3), d = draw_real(random, -6, 0);
    PathFrictionLaw::Params p;
    p.kinetic = draw_positive(random, -4, 1);
    p.static_level = p.kinetic * (1 + draw_positive(random, -3, 0));
    if (i % 3) p.viscous = draw_positive(random, -3, 2);
    Mode mode = i % 2 ? PathFrictionLaw::stick : PathFrictionLaw::slip;
    const Real R = i % 2 ? p.static_level : p.kinetic;
    const Real lambda =
        project_twice<PathFrictionLaw>(BlockMatrix<1>(w), BlockVector<1>(d), p, mode)[0];
    int cases = 0;
    if (std::abs(-d / w) < R) {  // rest: delta = 0
      ++cases;
      EXPECT_NEAR(lambda, -d / w, 1e-12 * std::abs(d / w));
    }
    for (const Real sign :
         {1.0, -1.0}) {  // slip in direction sign: lambda = -sign R - c delta, delta = w lambda + d
      const Real delta = (d - sign * w * R) / (1 + w * p.viscous);
      if (sign * delta <= 0) continue;
      ++cases;
      EXPECT_NEAR(lambda, -sign * R - p.viscous * delta, 1e-11 * std::abs(lambda));
    }
    ASSERT_EQ(cases, 1) << i;
  }
}

TEST(PathFrictionLaw, ContinuousWhereItYields) {
  const PathFrictionLaw::Params p{.static_level = 0.1, .kinetic = 0.1, .viscous = 3};
  const Real w = 0.02, d = 0.002;
  for (const Mode start : {PathFrictionLaw::stick, PathFrictionLaw::slip}) {
    BlockVector<1> a, b;
    Mode mode = start;
    PathFrictionLaw::project(BlockMatrix<1>(w), BlockVector<1>(d - 1e-12), p, mode, a);
    PathFrictionLaw::project(BlockMatrix<1>(w), BlockVector<1>(d + 1e-12), p, mode, b);
    EXPECT_NEAR(a[0], b[0], 2.1e-12 / w);
  }
}

TEST(PathFrictionLaw, BreaksAwayOnlyAtTheStaticLevelAndBeyondTheBand) {
  const PathFrictionLaw::Params p{.static_level = 0.2, .kinetic = 0.1, .stick_slip = 1e-6};
  Mode mode = PathFrictionLaw::stick;
  using V = BlockVector<1>;
  EXPECT_FALSE(PathFrictionLaw::event(p, V(1e-3), mode, V(-0.19)));
  EXPECT_FALSE(PathFrictionLaw::event(p, V(0.9e-6), mode, V(-0.2)));
  EXPECT_TRUE(PathFrictionLaw::event(p, V(1.1e-6), mode, V(-0.2)));
  EXPECT_EQ(mode, PathFrictionLaw::slip);
  EXPECT_FALSE(PathFrictionLaw::event(p, V(1e-3), mode, V(-0.2)));
}

TEST(PathFrictionLaw, NeedsNoEventWhereBothLevelsAreTheSame) {
  const PathFrictionLaw::Params p{.static_level = 0.1, .kinetic = 0.1};
  Mode mode = PathFrictionLaw::stick;
  EXPECT_TRUE(PathFrictionLaw::at_limit(p, mode, -0.1));
  EXPECT_FALSE(PathFrictionLaw::at_limit(p, mode, -0.099));
  EXPECT_FALSE(PathFrictionLaw::event(p, BlockVector<1>(1e-3), mode, BlockVector<1>(-0.1)));
}

/// Whether (delta, lambda) fulfils the law of the pressing tip, to `scale` (m).
void expect_pressing(const Vec3& n, Real fp, Real mu, const Vec3& delta, const Vec3& lambda,
                     Real scale) {
  const Real ln = n.dot(lambda), dn = n.dot(delta);
  const Vec3 lt = lambda - ln * n, dt = delta - dn * n;
  ASSERT_GE(ln, -1e-12 * fp);
  ASSERT_LE(ln, fp * (1 + 1e-12));
  if (ln < fp * (1 - 1e-12)) {
    ASSERT_GE(dn, -scale);  // does not yield
  }
  if (ln > 1e-12 * fp) {
    ASSERT_LE(dn, scale);  // does not stand off
  }
  ASSERT_LE(lt.norm(), mu * ln + 1e-12 * fp);
  if (ln <= 0) return;
  if (lt.norm() < mu * ln * (1 - 1e-9)) {
    ASSERT_LT(dt.norm(), scale);
  } else if (dt.norm() > scale && lt.norm() > 1e-12 * fp) {
    ASSERT_LT((dt / dt.norm() + lt / lt.norm()).norm() * dt.norm(), 10 * scale);
  }
}

TEST(PunctureLaw, PressingIsOnItsGraph) {
  std::mt19937_64 random(3);
  int at_threshold = 0, open = 0;
  for (int i = 0; i < draws; ++i) {
    const Mat3 W = random_spd<3>(random);
    const Vec3 d = draw_vector<3>(random);
    PunctureLaw::Params p;
    p.normal = draw_unit(random);
    p.axis = (-p.normal + 0.5 * draw_unit(random)).normalized();
    p.puncture_force = draw_positive(random, -2, 1);
    p.friction = i % 4 ? draw_positive(random, -2, -0.3) : 0;
    Mode mode = PunctureLaw::pressing;
    const Vec3 lambda = project_twice<PunctureLaw>(W, d, p, mode);
    expect_pressing(p.normal, p.puncture_force, p.friction, W * lambda + d, lambda,
                    1e-8 * d.norm());
    const Real ln = p.normal.dot(lambda);
    const bool yields = ln >= p.puncture_force * (1 - 1e-12);
    ASSERT_EQ(mode, yields ? PunctureLaw::yielding : PunctureLaw::pressing);
    at_threshold += yields;
    open += ln == 0;
    const Vec3 delta = W * lambda + d;
    Mode after = mode;
    // Events only at the threshold while the surface yields.
    EXPECT_EQ(PunctureLaw::event(p, delta, after, lambda), yields && p.normal.dot(delta) < 0);
    if (!yields || !(p.normal.dot(delta) < 0)) continue;
    // The same pair of delta and lambda where the normal has turned by a tenth of a radian.
    PunctureLaw::Params turned = p;
    turned.normal = (p.normal + 0.1 * p.normal.unitOrthogonal()).normalized();
    after = mode;
    EXPECT_EQ(PunctureLaw::event(turned, delta, after, lambda), turned.normal.dot(delta) < 0);
  }
  EXPECT_GT(at_threshold, draws / 20);
  EXPECT_GT(open, draws / 10);
}

TEST(PunctureLaw, PenetratedIsTheOneConsistentCase) {
  std::mt19937_64 random(4);
  int count[3] = {};
  for (int i = 0; i < draws; ++i) {
    const Mat3 W = random_spd<3>(random);
    const Vec3 d = draw_vector<3>(random);
    PunctureLaw::Params p;
    p.axis = draw_unit(random);
    p.normal = -p.axis;
    p.cutting_force = i % 4 ? draw_positive(random, -2, 1) : 0;
    p.drag = i % 3 ? draw_positive(random, -2, 2) : 0;
    Mode mode = PunctureLaw::penetrated;
    const Vec3 lambda = project_twice<PunctureLaw>(W, d, p, mode);
    ASSERT_EQ(mode, PunctureLaw::penetrated);
    // Axial force r given or axial delta given; the two lateral deltas vanish. Lagrange form in
    // world axes.
    const Mat3 across = Mat3::Identity() - p.axis * p.axis.transpose();
    const auto with_force = [&](Real r, Real drag) {
      // across (W lambda + d) = 0, axis . lambda = -(r + drag axis . (W lambda + d))
      const Mat3 along = p.axis * p.axis.transpose();
      const Mat3 M = across * W + along + drag * along * W;
      return Vec3(M.fullPivLu().solve(-across * d - r * p.axis - drag * along * d));
    };
    const Vec3 held = -W.fullPivLu().solve(d);
    const Real r = -p.axis.dot(held);
    int cases = 0;
    Vec3 expected = Vec3::Zero();
    if (r > 0 && r < p.cutting_force) expected = held, ++cases, ++count[0];
    if (const Vec3 f = with_force(p.cutting_force, p.drag); p.axis.dot(W * f + d) > 0)
      expected = f, ++cases, ++count[1];
    if (const Vec3 f = with_force(0, 0); p.axis.dot(W * f + d) < 0)
      expected = f, ++cases, ++count[2];
    ASSERT_EQ(cases, 1) << i;
    ASSERT_LT((lambda - expected).norm(), 1e-9 * (1 + expected.norm())) << i;
  }
  for (const int c : count) EXPECT_GT(c, draws / 50);
}

TEST(PunctureLaw, ContinuousWhereItYields) {
  // Normal z, w = 0.01: the threshold 1 N is met at d = -0.01.
  PunctureLaw::Params p;
  p.puncture_force = 1;
  p.friction = 0.3;
  const Mat3 W = 0.01 * Mat3::Identity();
  for (const Real slide : {0.001, 0.02}) {
    Mode mode = PunctureLaw::pressing;
    Vec3 a, b;
    PunctureLaw::project(W, Vec3(slide, 0, -0.01 + 1e-12), p, mode, a);
    PunctureLaw::project(W, Vec3(slide, 0, -0.01 - 1e-12), p, mode, b);
    EXPECT_LT((a - b).norm(), 3e-12 / 0.01);
    EXPECT_NEAR(b.z(), 1, 1e-9);
    EXPECT_NEAR(b.x(), -std::min(slide / 0.01, 0.3), 1e-9);
  }
}

TEST(PunctureLaw, FromInsideIsTheMirrorImage) {
  // Exit: normal and axis reversed; the same displacement mirrored gives the mirrored force.
  std::mt19937_64 random(5);
  for (int i = 0; i < 1000; ++i) {
    const Mat3 W = random_spd<3>(random);
    const Vec3 d = draw_vector<3>(random);
    PunctureLaw::Params in;
    in.normal = draw_unit(random);
    in.axis = -in.normal;
    in.puncture_force = 1;
    in.friction = 0.2;
    PunctureLaw::Params out = in;
    out.normal = -in.normal;
    out.axis = -in.axis;
    Mode mode = PunctureLaw::pressing;
    Vec3 a, b;
    PunctureLaw::project(W, d, in, mode, a);
    PunctureLaw::project(W, -d, out, mode, b);
    EXPECT_LT((a + b).norm(), 1e-9 * (1 + a.norm()));
  }
}

}  // namespace
