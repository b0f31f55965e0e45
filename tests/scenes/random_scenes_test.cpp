// 200 small scenes drawn at random, and what must hold in every step of each of them: Newton's
// third law, forces inside the sets that their laws admit, no irreversible event that a reference
// solver would not have fired, everything finite.
#include <gtest/gtest.h>

#include <algorithm>

#include "../../plugins/suturing/puncture_law.h"
#include "house/command.h"
#include "random_scene.h"
#include "solve/law_residual.h"
#include "step_checks.h"
#include "watched_run.h"

namespace sutura::testing {
namespace {

constexpr int shards = 8, scenes_per_shard = 25;

/// Largest distance by which a node of one body has moved since `x`, which becomes the present.
Real moved(const Body& body, std::vector<Vec3>& x) {
  const std::vector<Vec3> now = body.geometry().points;
  Real most = 0;
  for (std::size_t i = 0; i < now.size() && i < x.size(); ++i)
    most = std::max(most, (now[i] - x[i]).norm());
  x = now;
  return most;
}

struct Counts {
  Index steps = 0, rows = 0, events = 0, entries = 0, layers = 0, exits = 0, retractions = 0,
        overruns = 0, inverted = 0;
  Index not_solved = 0;
  Real force = 0, moment = 0, off_curve = 0, gap_excess = 0, outside = 0, off_graph = 0;
};

void run_scene(std::uint64_t seed, const std::filesystem::path& folder, Counts& counts) {
  RandomScene scene(seed);
  scene.may_divide = false;  // what is looked at is a whole step
  WatchedRun run(scene.write(folder));
  ASSERT_TRUE(run) << "seed " << seed;
  Simulation& simulation = run.simulation();
  Body& thread = run.body<CurveBody>();
  Body& tissue = run.body<SolidBody>();
  std::vector<Vec3> thread_x = thread.geometry().points, tissue_x = tissue.geometry().points;
  Real slip_bound = 0;
  const Real gap_tolerance = simulation.scene().limits.gap_tolerance;
  Index step = 0;
  WatchedStep watched;
  run.solver().look = [&](const ConstraintProblem& before, const ConstraintProblem& after,
                          const SolveReport&) { watched.look(before, after); };

  /// The end of a step that was solved: rows, forces and bodies as they are there.
  const auto judge = [&](const StepReport& report) {
    const std::string where = "seed " + std::to_string(seed) + " step " + std::to_string(step);
    const ConstraintProblem& end = simulation.problem();
    const ThirdLaw third = third_law(simulation, end);
    EXPECT_LE(third.force, 1e-10) << where;
    EXPECT_LE(third.moment, 1e-10) << where;
    counts.force = std::max(counts.force, third.force);
    counts.moment = std::max(counts.moment, third.moment);
    // Rows act on the centreline: 1e-9 m is what the search for the closest point leaves.
    EXPECT_LE(third.off_curve, 1e-9) << where;
    counts.off_curve = std::max(counts.off_curve, third.off_curve);
    // What a path block leaves between its two points: what the wall gives way, and along the
    // thread the slip of the step.
    const Real bound = run.output("/path", "lateral_gap") + slip_bound + gap_tolerance;
    EXPECT_LE(third.gap, bound) << where;
    counts.gap_excess = std::max(counts.gap_excess, third.gap - bound);
    std::string who;
    // The step promises gap_tolerance, a length; twice it, for the compliance is that of the pass
    // before the end.
    const ForceTolerance tolerance(watched.after, 2 * gap_tolerance);
    const Real outside = outside_admissible(end, tolerance, who);
    EXPECT_LE(outside, 1) << where << " " << who;
    counts.outside = std::max(counts.outside, outside);
    const Real off = off_graph(end, tolerance, who);
    EXPECT_LE(off, 2 * gap_tolerance) << where << " " << who;
    counts.off_graph = std::max(counts.off_graph, off);

    // Nothing that is due was left undone.
    ConstraintProblem due = end;
    EXPECT_EQ(fire_events(due), 0) << where;

    counts.events += report.solve.events;
    if (!watched.any || report.parts > 1) return;  // else `first` is of another part
    const ConstraintProblem start = watched.start();
    const PunctureCount fired = punctures(start, watched.after);
    counts.entries += fired.entries, counts.layers += fired.layers, counts.exits += fired.exits;
  };

  Real deepest = 0;
  bool retracted = false;
  for (; step < scene.steps; ++step) {
    watched.any = false;
    const StepReport& report = simulation.step();
    ASSERT_TRUE(report.finite) << "seed " << seed << " step " << step;
    slip_bound = moved(thread, thread_x) + moved(tissue, tissue_x);
    if (report.solved)
      judge(report);
    else
      ++counts.not_solved;
    // A needle pressed deeper than an element can follow: the mesh is too coarse, and the report
    // says so.
    counts.inverted += static_cast<Index>(report.faults.size());
    counts.rows += report.rows;
    const Real depth = run.output("/path", "tip_depth");
    retracted = retracted || depth < deepest - 1e-3;
    deepest = std::max(deepest, depth);
  }
  counts.steps += step;
  counts.overruns += static_cast<Index>(run.output("/puncture", "overruns"));
  counts.retractions += retracted;
}

class RandomScenes : public ::testing::TestWithParam<int> {};

TEST_P(RandomScenes, KeepTheLawsInEveryStep) {
  const house::TemporaryFolder folder("random_scenes_" + std::to_string(GetParam()));
  Counts counts;
  for (int i = 0; i < scenes_per_shard; ++i)
    run_scene(static_cast<std::uint64_t>(GetParam() * scenes_per_shard + i + 1), folder.path(),
              counts);
  std::printf(
      "%td steps, %td rows, %td events, %td entries, %td layers, %td exits, %td overruns, %td "
      "inverted, %td retractions; "
      "not solved %td\n"
      "force %.1e moment %.1e off curve %.1e gap excess %.1e outside %.1e graph %.1e\n",
      counts.steps, counts.rows, counts.events, counts.entries, counts.layers, counts.exits,
      counts.overruns, counts.inverted, counts.retractions, counts.not_solved, counts.force,
      counts.moment, counts.off_curve, counts.gap_excess, counts.outside, counts.off_graph);
  // The scenes do what they are meant to.
  EXPECT_GE(counts.events, 100);
  EXPECT_GE(counts.entries, scenes_per_shard / 2);
  EXPECT_GE(counts.layers + counts.exits, 1);
  EXPECT_GE(counts.retractions, scenes_per_shard / 4);
  EXPECT_LE(10 * counts.inverted, counts.steps);
  // A step that is not solved says so and is not judged: one in a hundred may.
  EXPECT_LE(100 * counts.not_solved, counts.steps);
}

/// The checks above see what they are there for: each is shown a solution with one thing wrong.
TEST(StepChecks, FindWhatIsWrong) {
  const house::TemporaryFolder folder("step_checks");
  RandomScene scene(2);
  scene.may_divide = false;
  WatchedRun run(scene.write(folder.path()));
  ASSERT_TRUE(run);
  Index punctured = 0, dragged = 0;
  WatchedStep watched;
  run.solver().look = [&](const ConstraintProblem& before, const ConstraintProblem& after,
                          const SolveReport&) { watched.look(before, after); };
  const auto check = [&](const StepReport&) {
    std::string who;
    const ConstraintProblem start = watched.start();
    if (punctures(start, watched.after).entries > 0) ++punctured;
    const ConstraintProblem& end = run.simulation().problem();
    if (end.blocks.size() < 4) return;
    ++dragged;
    const ForceTolerance tolerance(watched.after, 1e-6);
    ConstraintProblem off = end;
    off.bodies[0].value[0] *= 1 + 1e-6;  // one coefficient of one row
    const ThirdLaw third = third_law(run.simulation(), off);
    EXPECT_GT(third.force + third.moment, 1e-10);
    for (const ConstraintBlock& b : end.blocks) {
      if (std::string_view(b.law->name) != "path_friction") continue;
      off = end;
      off.lambda[b.first_row] += 1;
      EXPECT_GT(outside_admissible(off, tolerance, who), 1);
      off = end;
      off.delta[b.first_row] += 1e-3 * (end.lambda[b.first_row] < 0 ? -1 : 1);
      EXPECT_GT(off_graph(off, tolerance, who), 1e-4);
    }
  };
  for (Index i = 0; i < scene.steps; ++i) {
    watched.any = false;
    const StepReport& report = run.simulation().step();
    if (watched.any && report.solved && report.parts == 1) check(report);
  }
  EXPECT_GE(punctured, 1);
  EXPECT_GE(dragged, 5);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomScenes, ::testing::Range(0, shards));

}  // namespace
}  // namespace sutura::testing
