// The step: who is asked in which stage, what the report says, what stops a recording.
#include <algorithm>

#include "unit/runtime/toys.h"

namespace sutura::toys {
namespace {

TEST(Step, AsksInTheOrderOfTheStages) {
  const World w("<Mass name='m'/><Pin name='p'/><Clock name='c'/>");
  ASSERT_TRUE(w.simulation) << w.messages();
  log().clear();
  w.simulation->step();
  // One pass: everything here is linear.
  EXPECT_EQ(log(), (Log{"drive /c", "detect /p", "build /p", "linearise /m", "correct /m",
                        "detect /p", "build /p", "commit /p"}));
}

TEST(Step, ForcesOfConstraintsReachTheBodies) {
  const World w("<Mass name='held'/><Mass name='free'/><Pin name='p' mass='/held'/>");
  ASSERT_TRUE(w.simulation) << w.messages();
  for (int i = 0; i < 10; ++i) w.simulation->step();
  // 1 kg at 10 m/s^2, and the tolerance of the solver, 1e-5 of 0.1 N and 0.1 mm.
  EXPECT_LT((w.get<Pin>("/p").force - Vec3(0, 0, 10)).norm(), 1e-5);
  EXPECT_LT(w.get<Mass>("/held").x.norm(), 1e-8);
  // Implicit Euler: x = g h^2 (1 + 2 + ... + 10).
  EXPECT_NEAR(w.get<Mass>("/free").x.z(), -10 * 0.01 * 55, 1e-12);
}

TEST(Step, TheReportCounts) {
  const World w("<Mass name='m'/><Pin name='p'/><LatePin name='q' after='/p'/>");
  ASSERT_TRUE(w.simulation) << w.messages();
  w.simulation->step();
  const StepReport& report = w.simulation->step();
  EXPECT_EQ(report.step, 2);
  EXPECT_DOUBLE_EQ(report.time, 0.2);
  EXPECT_EQ(report.blocks, 2);
  EXPECT_EQ(report.rows, 6);
  EXPECT_TRUE(report.solve.converged);
  EXPECT_TRUE(report.solved);
  EXPECT_EQ(report.passes, 1);
  EXPECT_EQ(report.parts, 1);
  EXPECT_LT(report.worst_imbalance().relative, 1e-12);  // rounding
  double sum = 0;
  for (const double s : report.seconds) {
    EXPECT_GE(s, 0);
    sum += s;
  }
  EXPECT_EQ(report.total_seconds(), sum);
}

TEST(Step, TimeIsAProductAndNotASum) {
  const World w("<Clock name='c'/>");
  ASSERT_TRUE(w.simulation) << w.messages();
  for (int i = 0; i < 1000; ++i) w.simulation->step();
  const Clock& clock = w.get<Clock>("/c");
  EXPECT_EQ(clock.begin.back(), 999 * 0.1);  // to the bit: sums of 0.1 would be off by 1e-12
  EXPECT_EQ(w.simulation->time(), 1000 * 0.1);
}

TEST(Step, AStateThatIsNotFiniteIsReportedAndNotCommitted) {
  const World w("<Mass name='m' fails_at='1'/><Pin name='p'/>");
  ASSERT_TRUE(w.simulation) << w.messages();
  EXPECT_TRUE(w.simulation->step().finite);
  log().clear();
  const StepReport& report = w.simulation->step();
  EXPECT_FALSE(report.finite);
  EXPECT_EQ(report.messages, (std::vector<std::string>{"/m: it broke"}));
  EXPECT_EQ(std::count(log().begin(), log().end(), "commit /p"), 0);
}

TEST(Recording, StartsWithTheInitialStateAndOnlyWhenAsked) {
  const World w("<Notes name='n'/>");
  ASSERT_TRUE(w.simulation) << w.messages();
  w.simulation->step();
  EXPECT_TRUE(w.get<Notes>("/n").steps.empty());
  EXPECT_EQ(w.simulation->start_recording(), "");
  w.simulation->step();
  w.simulation->step();
  EXPECT_EQ(w.simulation->finish_recording(), "");
  w.simulation->step();
  EXPECT_EQ(w.get<Notes>("/n").steps, (std::vector<Index>{1, 2, 3}));
  EXPECT_TRUE(w.get<Notes>("/n").finished);
}

TEST(Recording, StopsForAllAtTheFirstError) {
  const World w("<Notes name='n' breaks_at='2'/><Notes name='other'/>");
  ASSERT_TRUE(w.simulation) << w.messages();
  EXPECT_EQ(w.simulation->start_recording(), "");
  for (int i = 0; i < 4; ++i) w.simulation->step();
  EXPECT_EQ(w.simulation->record_error(), "/n: the disk is full");
  EXPECT_EQ(w.get<Notes>("/n").steps, (std::vector<Index>{0, 1, 2}));
  EXPECT_EQ(w.get<Notes>("/other").steps, (std::vector<Index>{0, 1}));
  EXPECT_EQ(w.simulation->finish_recording(), "/n: the disk is full");
  EXPECT_TRUE(w.get<Notes>("/other").finished);  // closed all the same
}

}  // namespace
}  // namespace sutura::toys
