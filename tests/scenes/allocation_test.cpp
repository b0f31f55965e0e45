// A step takes nothing from the heap once everything has been as large as it gets: every scene runs
// twice in one simulation, and the second run is counted. Where the first step has no more rows
// than a scene begins with, it takes nothing either. What the worker of a preconditioner does is
// not part of the step, and what CHOLMOD and BLAS take for themselves is theirs.
#include <gtest/gtest.h>

#include <algorithm>

#include "count_allocations.h"
#include "scenes/suture_tasks.h"
#include "scenes/text_run.h"
#include "scenes/watched_run.h"

#ifdef SUTURA_COUNTS_ALLOCATIONS

namespace sutura::testing {
namespace {

namespace fs = std::filesystem;

void count_only_our_own() {
  test::uncounted().find({"cholmod", "suitesparse", "blas", "lapack"});
}

/// Empty: there is none.
std::string tissue_of(const Simulation& simulation) {
  std::string path;
  for (const auto& b : simulation.bodies())
    if (dynamic_cast<const SolidBody*>(b.body) != nullptr) path = b.path;
  return path;
}

/// Changes where a knot is found, becomes rigid or free again: to tell what it is takes a little.
std::vector<Real> knots_of(WatchedRun& run, const Simulation& simulation) {
  std::vector<Real> out;
  for (const Component* c : simulation.scene().components())
    if (c->info().name == "Knots")
      for (const char* name : {"found", "rigid", "releases"})
        out.push_back(run.output(c->path(), name));
  return out;
}

class SecondRun : public ::testing::TestWithParam<fs::path> {};

TEST_P(SecondRun, AllocatesNothing) {
  // The first punctures lie between; a simulation that was restored starts its worker anew, with
  // the first rows of a tissue (step 71 of the interrupted stitch).
  constexpr int steps = 160, begin = 75;
  // In factors of more rows Eigen takes its panels, beyond 128 kB each, from the heap.
  constexpr Index large = 650;
  WatchedRun run(GetParam());
  ASSERT_TRUE(run);
  Simulation& simulation = run.simulation();
  const std::string tissue = tissue_of(simulation);
  const auto analyses_now = [&] { return tissue.empty() ? 0 : run.output(tissue, "analyses"); };
  count_only_our_own();
  const std::vector<std::byte> start = simulation.save();
  for (int i = 0; i < steps; ++i) simulation.step();
  ASSERT_EQ(simulation.restore(start), "");
  int counted = 0, left_out = 0;
  Index rows = 0;
  for (int i = 0; i < steps; ++i) {
    const Real analyses = analyses_now();
    const std::vector<Real> knots = knots_of(run, simulation);
    const long before = test::allocations();
    const StepReport& report = simulation.step();
    const long here = test::allocations() - before;
    left_out += report.rows > large;
    if (report.rows > large || knots_of(run, simulation) != knots) continue;
    // Another order of elimination is another plan and another factor; a complaint takes words.
    if (i < begin || analyses_now() != analyses || !report.messages.empty() ||
        !report.faults.empty())
      continue;
    EXPECT_EQ(here, 0) << "step " << i << ", " << report.rows << " rows, " << report.parts
                       << " parts, " << report.passes << " passes";
    ++counted;
    rows = std::max(rows, report.rows);
  }
  EXPECT_GT(counted + left_out, 80);
  EXPECT_GE(counted, 50);
  EXPECT_GT(rows, 10);
}

// Whether it is free or rigid. To become the one or the other takes a little.
TEST(Knots, AllocateNothingWhileNothingChanges) {
  for (const bool rigid : {false, true}) {
    TextRun run =
        TextRun::file("components/Knots.xml", {{"/knots.rigidify", rigid ? "true" : "false"}});
    ASSERT_TRUE(run);
    run.run(0.42);
    EXPECT_EQ(run.number("/knots", "rigid"), rigid);
    count_only_our_own();
    const long before = test::allocations();
    run.run(0.45);
    EXPECT_EQ(test::allocations(), before) << rigid;
  }
}

/// Without the running suture: its thread is sampled anew at steps that are counted, and a vector
/// of Eigen's that gets another length takes other memory.
std::vector<fs::path> touching_scenes() {
  std::vector<fs::path> out;
  for (const char* folder : {"suture", "contact"})
    for (const auto& entry :
         fs::directory_iterator(SUTURA_SOURCE_DIR "/scenes/" + std::string(folder)))
      if (entry.path().extension() == ".xml" && entry.path().stem() != "running_tied")
        out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}
INSTANTIATE_TEST_SUITE_P(Scenes, SecondRun, ::testing::ValuesIn(touching_scenes()),
                         [](const auto& info) { return info.param.stem().string(); });

class FirstStep : public ::testing::TestWithParam<std::string> {};

// What the first step needs is made before, in `ready`. Counted, since a clock measures what else
// the machine does; per pass, because a scene that is let go takes more passes until it rests.
TEST_P(FirstStep, AllocatesNothingAndWorksAsMuchAsAnyOther) {
  WatchedRun run(suture_task(GetParam()));
  ASSERT_TRUE(run);
  Simulation& simulation = run.simulation();
  const std::string tissue = tissue_of(simulation);
  std::string solver;
  bool touches = false;  // a Contact makes its lists when it first looks
  for (const Component* c : simulation.scene().components()) {
    if (c->info().name == "AsyncPreconditioner") solver = c->path();
    touches = touches || c->info().name == "Contact";
  }
  const Real analyses = run.output(tissue, "analyses");
  const Real adopted = solver.empty() ? 0 : run.output(solver, "adopted_at");
  struct Work {
    const char* what;
    Real slack;  ///< on top of twice the median
    std::vector<Real> per_pass;
  };
  // A step at rest solves nothing iteratively: one iteration and one direct solve are little.
  Work linearisations{"linearisations", 0, {}}, iterations{"iterations", 1, {}},
      solves{"direct solves", 1, {}};
  count_only_our_own();
  for (int i = 0; i < 41; ++i) {
    const long before = test::allocations();
    const StepReport& report = simulation.step();
    const long here = test::allocations() - before;
    const Real passes = static_cast<Real>(report.passes);
    linearisations.per_pass.push_back(run.output(tissue, "linearisations") / passes);
    iterations.per_pass.push_back(solver.empty() ? 0 : run.output(solver, "iterations") / passes);
    solves.per_pass.push_back(static_cast<Real>(report.solve.direct_solves));  // of the last pass
    if (i > 0) continue;
    if (!touches) {
      EXPECT_EQ(here, 0);
    }
    if (report.parts > 1) continue;  // for shorter steps it makes another factor
    EXPECT_EQ(run.output(tissue, "analyses"), analyses) << "an order of elimination";
    if (!solver.empty()) {
      EXPECT_EQ(run.output(solver, "adopted_at"), adopted) << "a factor";
    }
  }
  for (Work* work : {&linearisations, &iterations, &solves}) {
    // A knot as it is laid closes in its first steps: all of its touches begin without a force.
    if (touches && work == &solves) continue;
    std::vector<Real>& n = work->per_pass;
    const Real first = n.front();
    std::nth_element(n.begin(), n.begin() + 20, n.end());
    EXPECT_LE(first, 2 * n[20] + work->slack) << work->what;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, FirstStep, ::testing::ValuesIn(suture_tasks()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace sutura::testing

#endif
