// Every scene through the C API: saved, run, restored and run again it gives the same bits, and so
// it does from its beginning.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

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

class HostState : public testing::TestWithParam<std::string> {};

TEST_P(HostState, SavedRunRestoredAndRunAgainGivesTheSameBits) {
  constexpr std::size_t before = 5;
  const sutura_simulation s = load_fixed(all_scenes().at(GetParam()));
  const std::vector<std::byte> first = state(s);
  ASSERT_EQ(sutura_step(s, before), SUTURA_OK) << sutura_error();
  const std::vector<std::byte> start = state(s);
  constexpr std::size_t steps = 100;
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

INSTANTIATE_TEST_SUITE_P(All, HostState, testing::ValuesIn(names()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace sutura::host_tests
