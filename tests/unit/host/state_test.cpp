// Going back to a state gives the same bits again, in one simulation and beside others.
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <thread>

#include "unit/host/loaded.h"

namespace sutura::host_tests {
namespace {

namespace fs = std::filesystem;

/// "suture_prick" -> suture/prick.xml
std::map<std::string, std::string> all_scenes() {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(scenes)) {
    const fs::path& file = entry.path();
    if (file.extension() == ".xml")
      out[file.parent_path().filename().string() + "_" + file.stem().string()] = file.string();
  }
  return out;
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const auto& [name, file] : all_scenes()) out.push_back(name);
  return out;
}

/// Settings by which factors are adopted a fixed number of steps after their snapshot: those that
/// are adopted when they are ready depend on the clock.
std::vector<std::string> fixed_lags(const std::string& file) {
  std::vector<std::string> out;
  const sutura_simulation s = load(file);
  std::size_t count = 0;
  EXPECT_EQ(sutura_component_count(s, &count), SUTURA_OK);
  for (std::size_t i = 0; i < count; ++i) {
    sutura_component c{};
    c.struct_size = sizeof c;
    EXPECT_EQ(sutura_component_at(s, i, &c), SUTURA_OK);
    if (std::string(c.type) != "AsyncPreconditioner") continue;
    out.push_back(std::string(c.path) + ".lag");
    out.push_back("3");
  }
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
  return out;
}

sutura_simulation load_fixed(const std::string& file) {
  const std::vector<std::string> settings = fixed_lags(file);
  std::vector<const char*> texts;
  for (const std::string& s : settings) texts.push_back(s.c_str());
  sutura_options how = options();
  how.settings = texts.data();
  how.setting_count = texts.size() / 2;
  return load(file, &how);
}

class Scene : public testing::TestWithParam<std::string> {};

TEST_P(Scene, SavedRunRestoredAndRunAgainGivesTheSameBits) {
  constexpr std::size_t before = 5;
  const sutura_simulation s = load_fixed(all_scenes().at(GetParam()));
  const std::vector<std::byte> first = state(s);
  ASSERT_EQ(sutura_step(s, before), SUTURA_OK) << sutura_error();
  const std::vector<std::byte> start = state(s);
  // Long scenes take minutes for a hundred steps; their kinds of components are in the others.
  const bool is_long = GetParam().starts_with("validation") || GetParam() == "suture_wound" ||
                       GetParam() == "components_Layer";
  std::size_t steps = is_long ? 10 : 100;
  if (const char* more = std::getenv("SUTURA_TEST_STEPS")) steps = std::strtoul(more, nullptr, 10);
  ASSERT_EQ(sutura_step(s, steps), SUTURA_OK) << sutura_error();
  const std::vector<std::byte> end = state(s);
  ASSERT_EQ(sutura_restore(s, start.data(), start.size()), SUTURA_OK) << sutura_error();
  EXPECT_EQ(state(s), start);
  ASSERT_EQ(sutura_step(s, steps), SUTURA_OK) << sutura_error();
  EXPECT_TRUE(state(s) == end);
  ASSERT_EQ(sutura_reset(s), SUTURA_OK) << sutura_error();
  EXPECT_EQ(state(s), first);
  ASSERT_EQ(sutura_step(s, before), SUTURA_OK) << sutura_error();
  EXPECT_TRUE(state(s) == start);
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
}

INSTANTIATE_TEST_SUITE_P(All, Scene, testing::ValuesIn(names()),
                         [](const auto& info) { return info.param; });

TEST(State, OfAnotherSceneOrDamagedIsRefused) {
  const sutura_simulation a = load(scenes + "components/Tissue.xml");
  const sutura_simulation b = load_text(held_thread);
  const std::vector<std::byte> before = state(b);
  std::vector<std::byte> other = state(a);
  EXPECT_EQ(sutura_restore(b, other.data(), other.size()), SUTURA_BAD_FILE);
  EXPECT_EQ(sutura_restore(a, other.data(), other.size() / 2), SUTURA_BAD_FILE);
  EXPECT_EQ(sutura_restore(a, other.data(), 0), SUTURA_BAD_FILE);
  other[other.size() / 2] ^= std::byte{1};
  EXPECT_EQ(sutura_restore(a, other.data(), other.size()), SUTURA_BAD_FILE);
  EXPECT_EQ(state(b), before);
  EXPECT_EQ(sutura_destroy(a), SUTURA_OK);
  EXPECT_EQ(sutura_destroy(b), SUTURA_OK);
}

TEST(Workers, SeveralSimulationsGiveTheBitsThatEachGivesAlone) {
  const std::vector<std::string> files{
      scenes + "suture/prick.xml", scenes + "components/SuturePath.xml",
      scenes + "components/Tissue.xml", scenes + "suture/prick.xml"};
  constexpr std::size_t steps = 40;
  const auto run = [](const std::string& file) {
    const sutura_simulation s = load_fixed(file);
    EXPECT_EQ(sutura_step(s, steps), SUTURA_OK) << sutura_error();
    std::vector<std::byte> out = state(s);
    EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
    return out;
  };
  std::vector<std::vector<std::byte>> alone, together(files.size());
  for (const std::string& file : files) alone.push_back(run(file));
  std::vector<std::thread> workers;
  for (std::size_t i = 0; i < files.size(); ++i)
    workers.emplace_back([&, i] { together[i] = run(files[i]); });
  for (std::thread& w : workers) w.join();
  for (std::size_t i = 0; i < files.size(); ++i) EXPECT_TRUE(alone[i] == together[i]) << files[i];
}

// A second call on a simulation at work is refused at once; none is lost, none crashes.
TEST(Workers, OneCallAtATime) {
  const sutura_simulation s = load_text(held_thread);
  std::atomic<int> done{0}, busy{0};
  std::vector<std::thread> workers;
  for (int w = 0; w < 4; ++w)
    workers.emplace_back([&] {
      for (int i = 0; i < 200; ++i) {
        const sutura_status status = sutura_step(s, 1);
        EXPECT_TRUE(status == SUTURA_OK || status == SUTURA_BUSY) << sutura_error();
        ++(status == SUTURA_OK ? done : busy);
      }
    });
  for (std::thread& w : workers) w.join();
  sutura_report report{};
  report.struct_size = sizeof report;
  ASSERT_EQ(sutura_get_report(s, &report), SUTURA_OK);
  EXPECT_EQ(report.step, done.load());
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
}

}  // namespace
}  // namespace sutura::host_tests
