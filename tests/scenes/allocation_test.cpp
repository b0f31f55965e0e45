// A step takes nothing from the heap once everything has been as large as it gets: every scene runs
// twice in one simulation, and the second run is counted. What the worker of a preconditioner does
// is not part of the step, and what CHOLMOD and BLAS take for themselves is theirs.
#include <gtest/gtest.h>

#include "count_allocations.h"
#include "scenes/suture_tasks.h"
#include "scenes/watched_run.h"

#ifdef SUTURA_COUNTS_ALLOCATIONS

namespace sutura::testing {
namespace {

class Allocations : public ::testing::TestWithParam<std::string> {};

TEST_P(Allocations, NoneInTheSecondRun) {
  // The first punctures lie between; a simulation that was restored starts its worker anew.
  constexpr int steps = 150, begin = 40;
  WatchedRun run(suture_task(GetParam()));
  ASSERT_TRUE(run);
  Simulation& simulation = run.simulation();
  std::string tissue;
  for (const auto& b : simulation.bodies())
    if (dynamic_cast<const SolidBody*>(b.body) != nullptr) tissue = b.path;
  test::uncounted().find({"cholmod", "suitesparse", "blas", "lapack"});
  const std::vector<std::byte> start = simulation.save();
  for (int i = 0; i < steps; ++i) simulation.step();
  ASSERT_EQ(simulation.restore(start), "");
  int counted = 0;
  for (int i = 0; i < steps; ++i) {
    const Real analyses = run.output(tissue, "analyses");
    const long before = test::allocations();
    const StepReport& report = simulation.step();
    const long here = test::allocations() - before;
    // Another order of elimination is another plan and another factor; a complaint takes words.
    if (i < begin || run.output(tissue, "analyses") != analyses || !report.messages.empty() ||
        !report.faults.empty())
      continue;
    EXPECT_EQ(here, 0) << "step " << i << ", " << report.rows << " rows, " << report.parts
                       << " parts, " << report.passes << " passes";
    ++counted;
  }
  EXPECT_GT(counted, 80);
  EXPECT_GT(simulation.report().rows, 10);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Allocations, ::testing::ValuesIn(suture_tasks()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace sutura::testing

#endif
