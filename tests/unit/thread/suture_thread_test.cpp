#include "suture_thread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "divided_step.h"
#include "step_alone.h"

namespace sutura::thread {
namespace {

/// A component as the scene would make it, with its setup.
struct Suture {
  Diagnostics diagnostics;
  SutureThread thread;
  void initialise() {
    Setup setup{diagnostics, {}, {}, 0.01, Vec3::Zero(), 1};
    thread.initialise(setup);
    thread.ready(setup);
  }
  Index hold(Real at) {
    const Index number = thread.add_hold(at);
    Setup setup{diagnostics, {}, {}, 0.01, Vec3::Zero(), 1};
    thread.ready(setup);  // holds are spoken for before
    return number;
  }
  void steps(int count, Real dt = 0.01, const Vec3& gravity = Vec3::Zero()) {
    for (int i = 0; i < count; ++i) {
      const StepContext context{.dt = dt, .time = time, .step = i, .gravity = gravity};
      if (test::step_alone(thread, context, test::Alone{well_balanced, 100}) == 0) ++unbalanced;
      time += dt;
    }
  }
  Real time = 0;
  int unbalanced = 0;  ///< steps
};

TEST(SutureThread, NeedleIsTheArcAskedFor) {
  Suture s;
  s.thread.tip = Vec3(0.01, 0, 0.02);
  s.thread.tip_direction = Vec3(0, 0, -1);
  s.thread.plane_normal = Vec3(0, 1, 0);
  s.initialise();
  const auto& t = s.thread;
  EXPECT_LT((t.point(0, Configuration::rest) - s.thread.tip).norm(), 1e-15);
  EXPECT_LT((t.tangent(0, Configuration::rest) - Vec3(0, 0, 1)).norm(), 1e-12);
  // Half circle: the swage is a diameter away, on the side of the centre, pointing the other way.
  const Real radius = 26e-3 / std::numbers::pi;
  const Vec3 centre = s.thread.tip - radius * s.thread.tip_direction.cross(s.thread.plane_normal);
  EXPECT_LT((t.point(26e-3, Configuration::rest) - (2 * centre - s.thread.tip)).norm(), 1e-12);
  // The cubic of a 15 degree arc is off by radius theta^4/384/... < 2e-5 of the radius.
  for (const Real a : {1e-3, 5.5e-3, 13e-3, 22.22e-3})
    EXPECT_NEAR((t.point(a, Configuration::rest) - centre).norm(), radius, 2e-5 * radius);
  // Moving along the arc, the frame's x axis is the tangent and its z axis the plane's normal.
  for (const Real a : {0., 7e-3, 26e-3}) {
    const Pose f = t.frame(a, Configuration::rest);
    EXPECT_LT((f.rotation * Vec3::UnitX() - t.tangent(a, Configuration::rest)).norm(), 1e-12);
    EXPECT_LT((f.rotation * Vec3::UnitZ() - s.thread.plane_normal).norm(), 1e-12);
  }
  EXPECT_EQ(t.needle_length(), 26e-3);
  EXPECT_EQ(t.radius(1e-3), 0.325e-3);
  EXPECT_EQ(t.radius(0.1), 0.0875e-3);
}

TEST(SutureThread, ThreadLaidOutInAnotherDirectionKeepsItsLength) {
  Suture s;
  s.thread.thread_direction = Vec3(0, 0, 1);
  s.initialise();
  EXPECT_LT((s.thread.tangent(0.2, Configuration::current) - Vec3::UnitZ()).norm(), 1e-12);
  // Beams of 3 mm, bent by 0.6 rad, some only in part: their arc is not one of constant curvature.
  EXPECT_LT(s.thread.largest_strain(), 5e-3);
  EXPECT_NEAR(s.thread.largest_curvature(), 1 / s.thread.thread_bend_radius,
              0.02 / s.thread.thread_bend_radius);
}

TEST(SutureThread, JacobianIsTheDerivativeOfThePoint) {
  Suture s;
  s.initialise();
  s.steps(3, 0.01, Vec3(1, 2, -9.81));  // leave the rest state
  const auto& rod = s.thread.rod();
  for (const Real a : {0., 3.3e-3, 26e-3, 0.1003, 0.326}) {
    PointJacobian j;
    s.thread.jacobian(a, j);
    ASSERT_EQ(j.nodes, 2);
    Eigen::Matrix<Real, 3, 12> expected;
    const auto poses = rod.poses(Configuration::current);
    for (int i = 0; i < 12; ++i) {
      const auto moved = [&](Real d) {
        Pose end[2] = {poses[j.node[0]], poses[j.node[1]]};
        Pose& p = end[i / 6];
        if (i % 6 < 3)
          p.position[i % 6] += d;
        else
          p.rotation = rotated(p.rotation, d * Vec3::Unit(i % 6 - 3));
        const Cubic c(end[0], end[1], rod.element(j.node[0]).length);
        return c.point((a - rod.abscissa()[j.node[0]]) / rod.element(j.node[0]).length);
      };
      expected.col(i) = (moved(1e-5) - moved(-1e-5)) / 2e-5;
    }
    // Central differences: 1e-10 of the tangent's length plus rounding 1e-16/1e-5.
    EXPECT_LT((expected - j.coefficients).norm(), 1e-9) << a;
  }
}

TEST(SutureThread, ClosestAbscissaStaysOnItsStrand) {
  Suture s;
  s.thread.needle_arc_length = 0;
  s.thread.thread_length = 0.1;
  s.thread.thread_direction = Vec3(1, 0, 0);
  s.thread.tip_direction = Vec3(1, 0, 0);  // runs to -x, turns back to +x beside itself
  s.initialise();
  const auto c = Configuration::current;
  const Vec3 p = s.thread.point(0.06, c) + Vec3(0, 1e-4, 0);
  EXPECT_NEAR(s.thread.closest_abscissa(p, 0.055, 0, 0.1, c), 0.06, 1e-9);
  EXPECT_NEAR(s.thread.closest_abscissa(p, 0.099, 0, 0.1, c), 0.06, 1e-9);
  EXPECT_NEAR(s.thread.closest_abscissa(p, 0.055, 0.07, 0.1, c), 0.07, 1e-12);
  EXPECT_NEAR(s.thread.closest_abscissa(p, 0.09, 0.01, 0.05, c), 0.05, 1e-12);
}

TEST(SutureThread, HoldMakesANodeAndHoldsItsSection) {
  Suture s;
  s.initialise();
  const Real at = 15.5e-3;
  const Index hold = s.hold(at);
  const auto& a = s.thread.rod().abscissa();
  EXPECT_NE(std::find(a.begin(), a.end(), at), a.end());
  // Turn the section by 170 degrees about an arbitrary axis while shifting it, within 0.2 s.
  const Pose from = s.thread.frame(at, Configuration::rest);
  Pose target;
  for (int i = 1; i <= 20; ++i) {
    target.position = from.position + i / 20. * Vec3(5e-3, -2e-3, 1e-3);
    target.rotation = Quat(Eigen::AngleAxis<Real>(i / 20. * 170 * std::numbers::pi / 180,
                                                  Vec3(1, 2, -1).normalized())) *
                      from.rotation;
    s.thread.set_hold(hold, target, {});
    s.steps(1, 0.01, Vec3(0, 0, -9.81));
  }
  s.steps(400, 0.01, Vec3(0, 0, -9.81));
  EXPECT_LE(s.unbalanced, 20);  // while it turns by 8.5 degrees a step: passes alone, undivided
  const Pose now = s.thread.frame(at, Configuration::current);
  const Wrench w = s.thread.hold_wrench(hold);
  ASSERT_TRUE(s.thread.finite());
  EXPECT_LT((now.position - target.position).norm(), 1e-7);
  EXPECT_LT(rotation_between(now.rotation, target.rotation).norm(), 1e-3);
  // At rest the hold carries the weight; 4 s of implicit Euler leave swinging below 5 % of it.
  EXPECT_NEAR(w.force.z(), s.thread.mass() * 9.81, 0.05 * s.thread.mass() * 9.81);
  s.thread.release_hold(hold);
  EXPECT_EQ(s.thread.hold_wrench(hold).force.norm(), 0);
}

TEST(SutureThread, CondensedComplianceIsThatOfSolves) {
  for (const auto clamp : {SutureThread::Clamp::none, SutureThread::Clamp::both}) {
    Suture s;
    s.thread.thread_beams = 40;
    s.thread.clamp = clamp;
    s.initialise();
    const StepContext context{.dt = 0.01, .gravity = Vec3(0, 0, -9.81)};
    s.thread.begin_step(context);
    s.thread.linearise(context, VecX::Zero(s.thread.dofs()));
    BodyRows rows;
    rows.start.push_back(0);
    Index row = 0;
    for (const Real a : {0., 0.5e-3, 9e-3, 9.1e-3, 26e-3, 0.05, 0.12, 0.31, 0.326}) {
      PointJacobian j;
      s.thread.jacobian(a, j);
      for (int d = 0; d < 3; ++d) {
        rows.row.push_back(row++);
        rows.width = 6;
        for (int k = 0; k < 2; ++k) {
          rows.node.push_back(j.node[k]);
          for (int c = 0; c < 6; ++c) rows.value.push_back(j.coefficients(d, 6 * k + c));
        }
        rows.start.push_back(static_cast<Index>(rows.node.size()));
      }
    }
    MatX W = MatX::Zero(row, row), expected = W;
    s.thread.add_compliance(rows, context.dt, W);
    s.thread.Body::add_compliance(rows, context.dt, expected);  // one solve per row
    // Two orders of the same sums, on a matrix whose condition number is about 1e8 (EA against
    // mass).
    EXPECT_LT((W - expected).norm(), 1e-8 * expected.norm());
    EXPECT_LT((W - W.transpose()).norm(), 1e-8 * W.norm());
  }
}

TEST(SutureThread, SamplesDenselyWhereTheHeldThreadBends) {
  Suture s;
  s.thread.needle_arc_length = 0;
  s.thread.thread_length = 0.2;
  s.thread.thread_beams = 10;
  s.thread.sampling_angle = 0.2;
  s.thread.clamp = SutureThread::Clamp::start;
  s.initialise();
  const Index hold = s.hold(0.1);
  Pose target = s.thread.frame(0.1, Configuration::rest);
  target.position += Vec3(0.08, 0, 0);  // the half between clamp and hold is bent to a narrow loop
  for (int i = 1; i <= 100; ++i) {
    Pose p = target;
    p.position -= (1 - i / 100.) * Vec3(0.08, 0, 0) - Vec3(0, 0, 1e-3);
    s.thread.set_hold(hold, p, {});
    s.steps(1, 0.01, Vec3(0, 0, -9.81));
    ASSERT_TRUE(s.thread.finite()) << i;
  }
  s.steps(300, 0.01, Vec3(0, 0, -9.81));
  EXPECT_EQ(s.unbalanced, 0);
  EXPECT_GT(s.thread.rod().beams(), 20);
  const auto& a = s.thread.rod().abscissa();
  EXPECT_NE(std::find(a.begin(), a.end(), 0.1), a.end());
  for (Index e = 0; e < s.thread.rod().beams(); ++e)
    EXPECT_LE(turning_angle(s.thread.rod(), e), 0.2 + 1e-9);
}

TEST(SutureThread, RefusesADirectionlessNeedle) {
  Suture s;
  s.thread.plane_normal = s.thread.tip_direction;
  s.initialise();
  EXPECT_FALSE(s.diagnostics.ok());
}

TEST(SutureThread, SaysWhatWentWrong) {
  {
    Suture s;
    s.initialise();
    s.steps(3, 0.01, Vec3(0, 0, -9.81));
    EXPECT_EQ(s.thread.trouble(), "");
  }
  {
    // A spring that pushes away makes the matrix indefinite, whatever part of the stiffness is
    // left out: there is no step.
    Suture s;
    s.initialise();
    s.thread.set_hold(s.hold(0.1), s.thread.frame(0.1, Configuration::current), {-1e9, -1e9});
    s.steps(1);
    EXPECT_NE(s.thread.trouble().find("not positive definite"), std::string::npos)
        << s.thread.trouble();
    EXPECT_EQ(s.unbalanced, 1);
    // Let go, the next step is judged by itself.
    s.thread.release_hold(0);
    s.steps(1);
    EXPECT_EQ(s.thread.trouble(), "");
    EXPECT_EQ(s.unbalanced, 1);
  }
}

}  // namespace
}  // namespace sutura::thread
