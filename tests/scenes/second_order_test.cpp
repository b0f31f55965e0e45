// `time_order="2"`: threads are of second order in time in steps without rows.
#include <cmath>

#include "scenes/text_run.h"
#include "sutura/units.h"

namespace sutura::testing {
namespace {

const std::string contact = "<plugin name='contact'/>";
TextRun carried(Real dt, const char* order) {
  return TextRun::file("validation/carried_thread.xml",
                       {{".dt", format_real(dt) + " s"}, {".time_order", order}});
}

Vec3 end_of(const TextRun& run) {
  return run.vector("/suture", "end_position");
}

// A hand carries a thread by its end, and it swings on. Its first mode has 115 ms, and the steps
// resolve that: halving them takes three quarters of the error away, and not half of it. Modes that
// no step resolves are damped.
TEST(SecondOrder, ASwungThreadConvergesByTheSquareOfTheStep) {
  const auto end = [](Real dt, const char* order) {
    TextRun run = carried(dt, order);
    for (int n = 0; n < std::lround(0.6 / dt); ++n)
      EXPECT_TRUE(run.simulation().step().solved) << n;
    return end_of(run);
  };
  const Vec3 coarse = end(1e-3, "2"), middle = end(0.5e-3, "2"), fine = end(0.25e-3, "2");
  EXPECT_NEAR((coarse - middle).norm() / (middle - fine).norm(), 4, 0.5);
  // Richardson: the limit is a third of the last change further on. Implicit Euler is further from
  // it with half of the step.
  const Vec3 limit = fine + (fine - middle) / 3;
  EXPECT_GT((end(0.25e-3, "1") - limit).norm(), (middle - limit).norm());
}

// Where there are rows in every step, both orders are the same run to the bit.
TEST(SecondOrder, StepsWithRowsLookBackOneStep) {
  const std::string scene =
      contact +
      "<SutureThread name='t' needle_length='0' tip='5 0 0.1 mm' tip_direction='1 0 0' "
      "thread_length='40 mm' thread_diameter='0.2 mm' thread_beams='20'/>"
      "<Tool name='table' shape='plane' axis='0 0 1'/><Contact tool='table' friction='0.3'/>"
      "<Track name='hand' times='0 0.1 s' positions='0 0 0  10 20 0 mm'/>"
      "<Grasper at='0' track='hand'/>";
  TextRun one(scene, "dt='5 ms'"), two(scene, "dt='5 ms' time_order='2'");
  ASSERT_TRUE(one && two) << one.said() << two.said();
  for (int n = 0; n < 20; ++n) {
    ASSERT_GT(one.simulation().step().rows, 0);
    EXPECT_EQ(two.simulation().step().order, 1);
    EXPECT_EQ(one.vector("/t", "end_position"), two.vector("/t", "end_position")) << n;
  }
}

// A loop of thread falls on a bar: of second order until it is near, of first order from then on.
TEST(SecondOrder, EndsWhereTouchesBegin) {
  TextRun run(
      contact +
          "<SutureThread name='t' needle_length='0' tip='20 0 10 mm' tip_direction='1 0 0' "
          "thread_length='40 mm' thread_diameter='0.2 mm' thread_beams='20'/>"
          "<Tool name='bar' shape='cylinder' radius='2 mm' axis='0 1 0'/><Contact tool='bar'/>",
      "dt='5 ms' time_order='2'");
  ASSERT_TRUE(run) << run.said();
  Index last = 2;
  for (int n = 0; n < 20; ++n) {
    const StepReport& report = run.simulation().step();
    EXPECT_TRUE(report.solved) << n;
    EXPECT_EQ(report.order, report.rows > 0 ? 1 : 2) << n;
    last = report.order;
  }
  EXPECT_EQ(last, 1);
}

const std::string rod =
    "<SutureThread name='t' needle_length='0' tip_direction='-1 0 0' thread_length='20 mm' "
    "thread_beams='10' thread_diameter='1 mm' thread_young='100 GPa' damping_stiffness='0.1 ms' ";

// The step before tells nothing about how a rod falls that a hand has held until now. So the first
// step is one of implicit Euler, g h^2 / 2 too far down. BDF2 then has the right velocity, and a
// third of what each step was too far is added in the next one: 3/4 g h^2 in all.
TEST(SecondOrder, WhatIsLetGoFallsAtOnce) {
  for (const Real dt : {2e-2, 1e-2, 2.5e-3}) {
    TextRun run(rod +
                    "settle='true'/><Track times='0 1 s' positions='0 0 0  0 0 0 m'/>"
                    "<Grasper at='10 mm' release='0.2 s'/>",
                "gravity='0 0 -9.81' time_order='2' dt='" + format_real(dt) + " s'");
    ASSERT_TRUE(run) << run.said();
    const auto height = [&] { return run.vector("/t", "end_position").z(); };
    const Real start = height(), fallen = 9.81 * 0.2 * 0.2 / 2, late = 0.75 * 9.81 * dt * dt;
    run.run(0.4);
    // 3^-10 of the last step's excess is still to come at 20 ms.
    EXPECT_NEAR(height(), start - fallen - late, 1e-4 * late) << dt;
  }
}

// A hand that carries a rod at 1 m/s stops, and lets go some steps later: then the rod stands.
TEST(SecondOrder, WhatAHandHasStoppedStands) {
  for (const char* dt : {"10 ms", "5 ms", "2.5 ms", "1 ms"})
    for (const char* release : {"0.101 s", "0.105 s", "0.11 s"}) {
      TextRun run(rod +
                      "velocity='1 0 0'/><Track times='0 0.1 1 s' positions='0 0 0  100 0 0  "
                      "100 0 0 mm'/><Grasper at='10 mm' release='" +
                      std::string(release) + "'/>",
                  "gravity='0 0 0' time_order='2' dt='" + std::string(dt) + "'");
      ASSERT_TRUE(run) << run.said();
      run.run(0.2);
      const Body& body = *run.simulation().bodies()[0].body;
      // Steps leave a hundredth of their forces out of balance: 1.5e-5 of its 1 m/s was seen.
      EXPECT_LT((run.vector("/t", "momentum") / body.mass()).norm(), 1e-4) << dt << release;
    }
}

// What swings freely never gains energy, resolved or not.
TEST(SecondOrder, AFreeHelixLosesEnergyOnly) {
  for (const char* dt : {"5 ms", "2.5 ms", "2 ms"}) {
    TextRun run(
        "<SutureThread name='t' needle_length='0' tip_direction='-1 0 0' "
        "thread_direction='0 1 0' thread_bend_radius='6 mm' thread_length='150 mm' "
        "thread_beams='60' thread_diameter='0.031 mm' thread_young='1.2 GPa' "
        "thread_rest_curvature='60 1/m' thread_rest_torsion='20 1/m'/>",
        "gravity='0 0 0' time_order='2' dt='" + std::string(dt) + "'");
    ASSERT_TRUE(run) << run.said();
    const Real energy = run.number("/t", "energy");
    for (int n = 0; n < 100; ++n) {
      run.simulation().step();
      // A step leaves up to a hundredth of its forces out of balance.
      EXPECT_LT(run.number("/t", "energy"), 1.001 * energy) << dt << " " << n;
    }
  }
}

// What two steps back was is part of the state: a run that goes on from one is the same to the bit.
TEST(SecondOrder, GoesOnFromAStateToTheBit) {
  TextRun whole = carried(5e-3, "2"), halved = carried(5e-3, "2"), on = carried(5e-3, "2");
  for (int n = 0; n < 10; ++n) {
    whole.simulation().step();
    halved.simulation().step();
  }
  ASSERT_EQ(on.simulation().restore(halved.simulation().save()), "");
  for (int n = 0; n < 10; ++n) {
    whole.simulation().step();
    on.simulation().step();
    EXPECT_EQ(end_of(whole), end_of(on)) << n;
  }
}

TEST(SecondOrder, OfAnotherNumberIsAnError) {
  for (const char* order : {"0", "3", "1.5", "two"}) {
    TextRun run("<SutureThread thread_length='50 mm'/>", std::string("time_order='") + order + "'");
    EXPECT_FALSE(run) << order;
    EXPECT_NE(run.said().find("time_order"), std::string::npos) << run.said();
  }
}

}  // namespace
}  // namespace sutura::testing
