// The balance of energy that a user can make from a CSV file, and a host that records nothing as
// well: EnergyProbe.
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

constexpr Real gravity = 9.81;

// A hand lifts a hanging thread by 10 mm: its work is m g h.
TEST(EnergyBalance, AHandLiftsAThread) {
  TextRun run(
      R"(<SutureThread name="s" needle_length="0" thread="4-0 nylon" thread_length="100 mm"
                       tip_direction="0 0 1" plane_normal="0 1 0" settle="true"/>
         <Track times="0 1 s" positions="0 0 0  0 0 10 mm" easing="smooth"/>
         <Grasper at="0"/>
         <EnergyProbe name="e"/>)",
      "gravity=\"0 0 -9.81\"");
  ASSERT_TRUE(run) << run.said();
  run.run(1.2);
  const Real lifted = 27.42021338e-6 * 0.1 * gravity * 0.01;  // d01: 27.42 mg/m
  EXPECT_NEAR(run.number("/e", "work_of_holds"), lifted, 1e-3 * lifted);
  EXPECT_NEAR(run.number("/e", "change"), lifted, 1e-3 * lifted);
  EXPECT_EQ(run.number("/e", "work_of_loads"), 0);
  EXPECT_EQ(run.number("/e", "work_of_constraints"), 0);
  // At most 15 mm/s, and at rest again: m v^2 / 2, 3e-10 J, is the scale of what can be lost.
  EXPECT_GT(run.number("/e", "lost"), 0);
  EXPECT_LT(run.number("/e", "lost"), 3e-10);
}

// A load that grows slowly does half of its end value times the way; all of it is stored.
TEST(EnergyBalance, ALoadPullsABlock) {
  TextRun run(
      R"(<BlockMesh box="0 0 0  30 20 10 mm" cells="3 3 2"/>
         <Tissue young="10 kPa" poisson="0.3"/>
         <Attach box="0 0 0  0 20 10 mm"/>
         <TissueLoad box="30 0 0  30 20 10 mm" force="0.02 0 0 N" times="0 0.8 s" factors="0 1"/>
         <EnergyProbe name="e"/>)");
  ASSERT_TRUE(run) << run.said();
  Real lost = 0;
  for (int i = 0; i < 100; ++i) {
    run.simulation().step();
    EXPECT_GE(run.number("/e", "lost"), lost - 1e-12);
    lost = run.number("/e", "lost");
  }
  const Real work = run.number("/e", "work_of_loads");
  EXPECT_NEAR(run.number("/e", "change"), work, 0.02 * work);
  EXPECT_NEAR(run.number("/tissue", "elastic_energy"), run.number("/e", "change"), 1e-4 * work);
  EXPECT_LT(run.number("/tissue", "kinetic_energy"), 1e-4 * work);
  EXPECT_EQ(run.number("/e", "work_of_holds"), 0);
}

// A face is carried away: the work of the hand is half of the last force times the way.
TEST(EnergyBalance, AMovingSupportDoesWork) {
  TextRun run(
      R"(<BlockMesh box="0 0 0  30 20 10 mm" cells="3 3 2"/>
         <Tissue young="10 kPa" poisson="0.3"/>
         <Attach name="wall" box="0 0 0  0 20 10 mm"/>
         <Track name="hand" times="0 1 s" positions="0 0 0  0.3 0 0 mm"/>
         <Attach name="grip" box="30 0 0  30 20 10 mm" motion="hand"/>
         <EnergyProbe name="e"/>)");
  ASSERT_TRUE(run) << run.said();
  run.run(1);
  const Real half = run.vector("/grip", "reaction").x() * 0.3e-3 / 2;
  EXPECT_GT(half, 0);
  EXPECT_NEAR(run.number("/e", "work_of_holds"), half, 0.03 * half);
  EXPECT_NEAR(run.number("/tissue", "elastic_energy"), half, 0.03 * half);
}

// Nearly all of the work of the holder is dissipated between needle and skin. What the rows took
// only grows, and is more than cutting alone takes: 0.1 N over the length of the channel.
TEST(EnergyBalance, ANeedleIsDrivenThroughSkin) {
  TextRun run = TextRun::file("validation/energy_balance.xml");
  ASSERT_TRUE(run);
  Real taken = 0, most = 0;
  while (run.simulation().time() < 1 - 1e-9) {
    run.simulation().step();
    taken =
        -run.number("/needle", "work_of_constraints") - run.number("/skin", "work_of_constraints");
    most = std::max(most, taken);
    EXPECT_GT(taken, most - 1e-6) << run.simulation().time();
  }
  const Real work = run.number("/needle", "work_of_holds");
  EXPECT_GT(taken, 0.1 * run.number("/suture_path", "tip_depth"));
  EXPECT_LT(taken, work);
  EXPECT_NEAR(run.number("/needle", "lost"), 0, 0.03 * work);
  EXPECT_GT(run.number("/skin", "lost"), 0);
  EXPECT_LT(run.number("/skin", "lost"), 0.05 * work);
}

}  // namespace
}  // namespace sutura::testing
