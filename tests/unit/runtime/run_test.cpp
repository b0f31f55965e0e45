// A run as a function: how it ends, and that it can go on.
#include "sutura/run.h"

#include "unit/runtime/toys.h"

namespace sutura::toys {
namespace {

struct OneRun {
  Diagnostics diagnostics;
  Registry registry;
  RunResult result;

  explicit OneRun(const std::string& elements, const RunOptions& options,
                  const RunObserver& observer = {}) {
    enrol_builtin(registry);
    registry.component<Mass>("Mass");
    registry.component<Notes>("Notes");
    registry.component<Broken>("Broken");
    auto scene =
        load_scene_text("<sutura version='1' dt='0.1 s' duration='1 s'>" + elements + "</sutura>",
                        "test.xml", ".", registry, diagnostics);
    if (scene) result = run_scene(std::move(scene), options, diagnostics, observer);
  }
};

std::filesystem::path folder() {
  return std::filesystem::path(testing::TempDir()) / "sutura_run_test";
}

TEST(Run, TakesTheStepsOfTheDuration) {
  Index seen = 0;
  const OneRun run("<Mass/>", {},
                   [&](Simulation&, const StepReport& step, const RunResult& so_far) {
                     EXPECT_EQ(step.step, ++seen);
                     EXPECT_EQ(so_far.steps, 10);
                     return true;
                   });
  EXPECT_EQ(run.result.end, RunEnd::done);
  EXPECT_EQ(run.result.message, "");
  EXPECT_EQ(run.result.last, 10);
  EXPECT_EQ(seen, 10);
  EXPECT_EQ(OneRun("<Mass/>", {.duration = 0.25}).result.last, 3);  // enough steps to get there
  EXPECT_EQ(OneRun("<Mass/>", {.steps = 4, .duration = 9}).result.last, 4);
}

TEST(Run, EndsWhenTheObserverSaysSo) {
  const OneRun run("<Mass/>", {}, [](Simulation&, const StepReport& step, const RunResult&) {
    return step.step < 3;
  });
  EXPECT_EQ(run.result.end, RunEnd::stopped);
  EXPECT_EQ(run.result.last, 3);
}

TEST(Run, SaysWhatWentWrong) {
  const OneRun diverged("<Mass fails_at='1'/>", {});
  EXPECT_EQ(diverged.result.end, RunEnd::diverged);
  EXPECT_EQ(diverged.result.last, 2);
  EXPECT_NE(diverged.result.message.find("after step 2"), std::string::npos);

  const OneRun disk("<Notes name='n' breaks_at='5'/>", {});
  EXPECT_EQ(disk.result.end, RunEnd::file_failed);
  EXPECT_EQ(disk.result.message, "/n: the disk is full");
  EXPECT_EQ(disk.result.last, 5);

  const OneRun refused("<Broken/>", {});
  EXPECT_EQ(refused.result.end, RunEnd::refused);
  EXPECT_FALSE(refused.diagnostics.ok());

  const OneRun state("<Mass/>", {.resume = "/nowhere/at/all"});
  EXPECT_EQ(state.result.end, RunEnd::file_failed);
  EXPECT_EQ(state.result.last, 0);
}

TEST(Run, GoesOnFromACheckpoint) {
  std::vector<std::byte> whole, resumed;
  const auto keep = [](std::vector<std::byte>& last) {
    return [&last](Simulation& simulation, const StepReport&, const RunResult&) {
      last = simulation.save();
      return true;
    };
  };
  const OneRun once("<Mass/>", {}, keep(whole));
  const OneRun cut("<Mass/>", {.output = folder(), .steps = 7, .checkpoint_every = 0.3});
  ASSERT_EQ(cut.result.message, "");
  const OneRun on("<Mass/>", {.output = folder(), .resume = checkpoint_file(folder())},
                  keep(resumed));
  ASSERT_EQ(on.result.message, "");
  EXPECT_EQ(on.result.first, 6);
  EXPECT_EQ(on.result.last, 10);
  EXPECT_TRUE(whole == resumed);
}

}  // namespace
}  // namespace sutura::toys
