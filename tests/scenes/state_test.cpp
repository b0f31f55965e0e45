// Every scene, saved at any step and restored, takes the same steps as if it had not been
// interrupted, to the bit: the states of both runs some steps later are compared as bytes. Factors
// are adopted a fixed number of steps after their snapshot (lag="3"), as a run that can be repeated
// asks for.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <random>
#include <set>

#include "house/command.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"

namespace sutura::testing {
namespace {

namespace fs = std::filesystem;

const fs::path scenes = SUTURA_SOURCE_DIR "/scenes";

/// "suture_prick" -> suture/prick.xml
std::map<std::string, fs::path> all_scenes() {
  std::map<std::string, fs::path> out;
  for (const auto& entry : fs::recursive_directory_iterator(scenes)) {
    const fs::path& file = entry.path();
    if (file.extension() == ".xml")
      out[file.parent_path().filename().string() + "_" + file.stem().string()] = file;
  }
  return out;
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const auto& [name, file] : all_scenes()) out.push_back(name);
  return out;
}

class Compiled {
 public:
  explicit Compiled(const fs::path& file) {
    enrol_builtin(registry_);
    LoadOptions options{.plugin_directories = {SUTURA_BINARY_DIR "/lib/sutura"}};
    Diagnostics diagnostics;
    auto scene = load_scene(file, registry_, diagnostics, options);
    if (scene) {  // free-running factors depend on the clock
      for (const Component* c : scene->components())
        if (c->info().name == "AsyncPreconditioner")
          options.overrides.emplace_back(c->path() + ".lag", "3");
      scene = load_scene(file, registry_, diagnostics, options);
    }
    if (scene) simulation_ = Simulation::compile(std::move(scene), ".", diagnostics);
    for (const Diagnostic& d : diagnostics.all())
      if (d.severity == Severity::error) ADD_FAILURE() << d.text();
  }
  explicit operator bool() const { return simulation_ != nullptr; }
  Simulation* operator->() { return simulation_.get(); }

 private:
  Registry registry_;
  std::unique_ptr<Simulation> simulation_;
};

class State : public ::testing::TestWithParam<std::string> {};

TEST_P(State, RestoredAtAnyStepGoesOnToTheBit) {
  constexpr Index on = 8;  // steps after which the bytes are compared: twice around the lag
  // Minutes each, with nothing late in them that other stitches and knots do not have: a few of
  // their first steps only.
  bool is_long = false;
  for (const char* long_one :
       {"three_bites", "two_threads", "tensioned_thread", "wound", "interrupted", "slip", "rigid",
        "suture_load", "anastomosis", "running"})
    is_long = is_long || GetParam().find(long_one) != std::string::npos;
  const fs::path file = all_scenes().at(GetParam());
  Compiled whole(file), resumed(file);
  ASSERT_TRUE(whole && resumed);
  const Scene& scene = whole->scene();
  // Scenes without a duration are the smallest ones of components: nothing new after some steps.
  const Index steps = is_long              ? 30
                      : scene.duration > 0 ? Index(std::ceil(scene.duration / scene.dt - 1e-6))
                                           : 40;
  std::mt19937_64 random(steps);
  std::set<Index> at{0};
  while (static_cast<Index>(at.size()) < std::min<Index>(is_long ? 4 : 20, steps - on))
    at.insert(static_cast<Index>(random() % static_cast<std::uint64_t>(steps - on)));

  std::map<Index, std::vector<std::byte>> saved;  // only those that are still to be compared
  for (Index step = 0; step <= *at.rbegin() + on; ++step) {
    if (step > 0 && !whole->step().finite) FAIL() << "diverged in step " << step;
    if (at.contains(step)) saved[step] = whole->save();
    if (!at.contains(step - on)) continue;
    const std::vector<std::byte> expected = whole->save();
    ASSERT_EQ(resumed->restore(saved[step - on]), "") << "at step " << step - on;
    for (Index i = 0; i < on; ++i) resumed->step();
    EXPECT_EQ(resumed->report().time, whole->report().time);
    EXPECT_TRUE(resumed->save() == expected) << "saved at step " << step - on;
    saved.erase(step - on);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, State, ::testing::ValuesIn(names()),
                         [](const auto& info) { return info.param; });

// The command: a run that is cut short and goes on leaves the same files as one that is not.

std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().extension() != ".sutura")
      out[entry.path().lexically_relative(folder).string()] = house::read_text(entry.path());
  return out;
}

TEST(Resume, LeavesTheFilesOfARunThatWasNotInterrupted) {
  const house::TemporaryFolder whole("whole"), cut("cut");
  const std::string run = "run '" + (scenes / "suture/prick.xml").string() + "' --output '";
  const house::Outcome once = house::command(run + whole.path().string() + "' --duration '1 s'");
  ASSERT_EQ(once.code, 0) << once.text;
  // It goes on to 0.8 s, beyond its last state at 0.6 s: those rows are cut off again.
  const std::string there = run + cut.path().string() + "' ";
  const house::Outcome first =
      house::command(there + "--duration '0.8 s' --checkpoint-every '0.3 s'");
  ASSERT_EQ(first.code, 0) << first.text;
  const std::string state = (cut.path() / "checkpoint.sutura").string();
  EXPECT_NE(files_of(whole.path()), files_of(cut.path()));
  const house::Outcome second = house::command(there + "--duration '1 s' --resume '" + state + "'");
  ASSERT_EQ(second.code, 0) << second.text;
  const auto expected = files_of(whole.path()), found = files_of(cut.path());
  ASSERT_GT(expected.size(), 3u);
  for (const auto& [name, text] : expected) {
    ASSERT_TRUE(found.contains(name)) << name;
    EXPECT_TRUE(found.at(name) == text) << name;
  }
  EXPECT_EQ(found.size(), expected.size());
}

TEST(Resume, RefusesAnotherSceneDamageAndAFileThatIsTooShort) {
  const house::TemporaryFolder folder("refuse");
  const std::string prick = "run '" + (scenes / "suture/prick.xml").string() + "' --output '" +
                            folder.path().string() + "' ";
  const std::string state = (folder.path() / "checkpoint.sutura").string();
  ASSERT_EQ(house::command(prick + "--steps 6 --checkpoint-every '30 ms'").code, 0);
  const std::string resume = "--steps 12 --resume '" + state + "'";

  const house::Outcome other = house::command(prick + resume + " --set /cutting.threshold='0.2 N'");
  EXPECT_EQ(other.code, 3);
  EXPECT_NE(other.text.find("another scene"), std::string::npos) << other.text;

  const house::Outcome none = house::command(prick + "--resume /nowhere/at/all --steps 9");
  EXPECT_EQ(none.code, 3);
  EXPECT_NE(none.text.find("/nowhere/at/all"), std::string::npos) << none.text;

  const std::string csv = house::read_text(folder.path() / "probe.csv");
  std::ofstream(folder.path() / "probe.csv") << csv.substr(0, csv.size() / 2);
  const house::Outcome shorter = house::command(prick + resume);
  EXPECT_EQ(shorter.code, 3);
  EXPECT_NE(shorter.text.find("probe.csv: it has"), std::string::npos) << shorter.text;

  std::string bytes = house::read_text(state);
  bytes[bytes.size() / 2] ^= 1;
  std::ofstream(state, std::ios::binary) << bytes;
  const house::Outcome damaged = house::command(prick + resume);
  EXPECT_EQ(damaged.code, 3);
  EXPECT_NE(damaged.text.find("damaged"), std::string::npos) << damaged.text;

  EXPECT_EQ(house::command(prick + "--steps 2 --checkpoint-every '3 mm'").code, 1);
  EXPECT_EQ(house::command(prick + "--steps 2 --checkpoint-every '0 s'").code, 1);
}

}  // namespace
}  // namespace sutura::testing
