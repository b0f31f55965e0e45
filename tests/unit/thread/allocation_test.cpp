// The step allocates nothing.
#include <gtest/gtest.h>

#include "count_allocations.h"
#include "divided_step.h"
#include "rod_builder.h"
#include "solve/gauss_seidel.h"
#include "step_alone.h"
#include "suture_thread.h"
#include "thread_problems.h"

#ifdef SUTURA_COUNTS_ALLOCATIONS

namespace sutura::thread {
namespace {

using test::allocations;

TEST(Allocation, CounterCounts) {
  const long before = allocations();
  {
    const VecX v = VecX::Ones(100);
    EXPECT_EQ(v.sum(), 100);
  }
  EXPECT_GT(allocations(), before);
}

TEST(Allocation, NoneInTheStep) {
  for (const bool violent : {false, true}) {
    Rod rod;
    RodLayout layout = straight_layout(0.2, 100, nylon());
    if (violent)
      for (std::size_t i = 1; i < layout.start.size(); i += 2) layout.start[i].position.z() += 2e-2;
    rod.build(layout);
    rod.clamp(0);
    RodStep step(rod);
    const VecX none = VecX::Zero(rod.dofs());
    const long before = allocations();
    Index most = 0;
    bool solved = true;
    for (int i = 0; i < 10; ++i) {
      const Index passes = step.advance(rod, 0.01, Vec3(0, 0, -9.81), none, well_balanced);
      solved = solved && passes > 0;
      most = std::max(most, passes);
    }
    EXPECT_EQ(allocations(), before) << (violent ? "violent" : "calm");
    // The violent one is no step that passes can solve: it goes through all that a pass may do.
    EXPECT_TRUE(violent || (solved && most < 10)) << most;
  }
}

// A moment at the end: its columns find their memory in the first step.
TEST(Allocation, NoneUnderAMomentThatKeepsItsDirection) {
  Rod rod;
  rod.build(straight_layout(0.1, 50, nylon()));
  rod.clamp(0);
  RodStep step(rod);
  VecX load = VecX::Zero(rod.dofs());
  load.tail<3>() = Vec3(1e-7, 2e-7, 0);
  step.set_load(load);
  const VecX none = VecX::Zero(rod.dofs());
  EXPECT_GT(step.advance(rod, 0.01, Vec3::Zero(), none, well_balanced), 0);
  const long before = allocations();
  for (int i = 0; i < 10; ++i)
    EXPECT_GT(step.advance(rod, 0.01, Vec3::Zero(), none, well_balanced), 0);
  EXPECT_EQ(allocations(), before);
}

/// A thread clamped at one end falls, swings and curls with adaptive sampling.
struct FallingThread {
  Diagnostics diagnostics;
  SutureThread thread;
  const StepContext context;
  explicit FallingThread(Index order)
      : context{.dt = 0.005, .order = order, .gravity = Vec3(0, 0, -9.81)} {
    thread.needle_arc_length = 0;
    thread.thread_beams = 20;
    thread.sampling_angle = 0.1;
    thread.clamp = SutureThread::Clamp::start;
    thread.thread_direction = Vec3(-1, 0, 1);  // laid out with a sharp bend
    sutura::Setup setup{diagnostics, {}, {}, context.dt, context.gravity, 1};
    thread.initialise(setup);
    thread.ready(setup);
  }
  /// Allocations of one step; `event` says whether it changed the nodes.
  long step(bool& event) {
    const VecX none = VecX::Zero(thread.dofs());
    const std::vector<Real> nodes = thread.rod().abscissa();
    const long before = allocations();
    test::step_alone(thread, context, none);
    const long after = allocations();
    event = thread.rod().abscissa() != nodes;
    return after - before;
  }
};

// Up to length/shortest_beam beams are declared at the start: from the first step on nothing
// allocates, events included.
class AllocationOf : public testing::TestWithParam<Index> {};

TEST_P(AllocationOf, NoStepOfASampledThread) {
  FallingThread s(GetParam());
  ASSERT_TRUE(s.diagnostics.ok());
  int events = 0, quiet = 0;
  Index most = 0, least = 1000;
  for (int i = 0; i < 600; ++i) {
    bool event = false;
    EXPECT_EQ(s.step(event), 0) << "step " << i << (event ? ", an event" : ", quiet");
    ++(event ? events : quiet);
    most = std::max(most, s.thread.rod().beams());
    least = std::min(least, s.thread.rod().beams());
  }
  EXPECT_GT(events, 20);
  EXPECT_GT(quiet, 100);
  EXPECT_GT(most, least + 10);  // split and merged
}

INSTANTIATE_TEST_SUITE_P(TimeOrder, AllocationOf, testing::Values(1, 2));

TEST(Allocation, NoneForTheRowsOfAThread) {
  test::ThreadPath path({.beams = 60, .samples = 20});
  ConstraintProblem problem;
  path.build(problem);
  BlockGaussSeidel solver;
  long before = 0;
  SolveReport report;
  for (int i = 0; i < 3; ++i) {
    if (i == 2) before = allocations();
    problem.lambda.setZero();
    path.make_compliance(problem);
    report = solver.solve(problem);
  }
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(report.sweeps, 0);
  EXPECT_GT(report.direct_solves, 0);
}

}  // namespace
}  // namespace sutura::thread

#endif
