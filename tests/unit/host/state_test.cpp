// A state that does not fit is refused; simulations beside each other.
#include <atomic>
#include <thread>

#include "unit/host/loaded.h"

namespace sutura::host_tests {
namespace {

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
