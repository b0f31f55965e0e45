// Every misuse has a status and a sentence.
#include <cmath>

#include "unit/host/loaded.h"

namespace sutura::host_tests {
namespace {

/// What is wrong, and that it was refused for it.
void refused(sutura_status status, const std::string& because) {
  EXPECT_EQ(status, SUTURA_MISUSE);
  EXPECT_NE(std::string(sutura_error()).find(because), std::string::npos)
      << "'" << sutura_error() << "' does not say '" << because << "'";
}

TEST(Misuse, OfHandles) {
  const sutura_simulation s = load_text(held_thread), other = load_text(held_thread);
  sutura_input hold = 0;
  sutura_tool tool = 0;
  ASSERT_EQ(sutura_find_input(s, "/grasper.hold", &hold), SUTURA_OK);
  ASSERT_EQ(sutura_find_tool(s, "/track", &tool), SUTURA_OK);
  const double one = 1;
  refused(sutura_step(0, 1), "expected a simulation, not 0");
  refused(sutura_step(hold, 1), "this one is that of an input");
  refused(sutura_set_input(tool, &one, 1), "expected the handle of an input");
  refused(sutura_step(~sutura_simulation{0}, 1), "expected the handle of a simulation");
  refused(sutura_set_input(hold + 100, &one, 1), "not the handle of an input");
  refused(sutura_step(s + 1, 1), "not the handle of a simulation");
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
  refused(sutura_destroy(s), "has been destroyed");
  refused(sutura_set_input(hold, &one, 1), "has been destroyed");
  EXPECT_EQ(sutura_step(other, 1), SUTURA_OK) << sutura_error();
  EXPECT_EQ(sutura_destroy(other), SUTURA_OK);
}

TEST(Misuse, OfPointersNumbersAndNames) {
  const sutura_simulation s = load_text(held_thread);
  std::uint64_t out = 0;
  refused(sutura_load(nullptr, nullptr, &out), "null");
  refused(sutura_load("a.xml", nullptr, nullptr), "null");
  refused(sutura_load_text(nullptr, 0, nullptr, nullptr, nullptr, &out), "null");
  refused(sutura_get_report(s, nullptr), "null");
  refused(sutura_save(s, nullptr, nullptr), "null");
  refused(sutura_restore(s, nullptr, 10), "null");
  refused(sutura_find_input(s, nullptr, &out), "null");
  refused(sutura_find_input(s, "/track.position", nullptr), "null");
  refused(sutura_find_input(s, "/track.positoin", &out), "did you mean 'position'?");
  refused(sutura_find_output(s, "/trak.position", &out), "did you mean '/track'?");
  refused(sutura_find_output(s, "position", &out), "expected a component");
  refused(sutura_find_body(s, "/sutur", &out), "did you mean '/suture'?");
  refused(sutura_find_tool(s, "/grasper", &out), "there is no tool '/grasper'");
  refused(sutura_input_at(s, 99, &out), "there is no input 99; there are 3");
  sutura_report report{};
  refused(sutura_get_report(s, &report), "struct_size is 0");
  sutura_options how = options();
  how.api = 99;
  refused(sutura_load("a.xml", &how, &out), "version 99 of the interface");
  how = options();
  how.struct_size = 8;
  refused(sutura_load("a.xml", &how, &out), "struct_size");
  how = options();
  how.setting_count = 1;
  refused(sutura_load("a.xml", &how, &out), "a setting is null");
  sutura_tool tool = 0;
  ASSERT_EQ(sutura_find_tool(s, "/track", &tool), SUTURA_OK);
  const double turned[7] = {0, 0, 0, 2, 0, 0, 0};
  const double lost[7] = {0, std::nan(""), 0, 1, 0, 0, 0};
  refused(sutura_set_pose(tool, turned), "no unit quaternion");
  refused(sutura_set_pose(tool, lost), "not finite");
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
}

// A struct of a later version is longer; what this library does not know is left alone.
TEST(Misuse, ALongerStructIsFilledAsFarAsItIsKnown) {
  struct Later {
    sutura_report known;
    double more;
  } later{{}, 5};
  later.known.struct_size = sizeof later;
  const sutura_simulation s = load_text(held_thread);
  ASSERT_EQ(sutura_get_report(s, &later.known), SUTURA_OK) << sutura_error();
  EXPECT_EQ(later.known.dt, 0.005);
  EXPECT_EQ(later.known.struct_size, sizeof later);
  EXPECT_EQ(later.more, 5);
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
}

TEST(Misuse, OfTheMessageFunction) {
  // A probe that cannot write says so in every step: it calls back into its own simulation.
  struct Seen {
    sutura_simulation simulation = 0;
    int calls = 0;
  } seen;
  sutura_options how = options();
  how.user = &seen;
  how.message = [](void* user, std::int32_t, const char*) {
    auto& s = *static_cast<Seen*>(user);
    ++s.calls;
    if (s.simulation == 0) return;
    EXPECT_EQ(sutura_step(s.simulation, 1), SUTURA_BUSY);
    EXPECT_EQ(sutura_destroy(s.simulation), SUTURA_BUSY);
  };
  // Five hundred times its weight crushes the block, which is a fault of every step.
  const char* settings[] = {".gravity", "0 0 -5000"};
  how.settings = settings;
  how.setting_count = 1;
  seen.simulation = load(scenes + "components/DirectSolver.xml", &how);
  seen.calls = 0;
  EXPECT_EQ(sutura_step(seen.simulation, 2), SUTURA_OK) << sutura_error();
  EXPECT_GE(seen.calls, 2);
  EXPECT_EQ(sutura_destroy(seen.simulation), SUTURA_OK);
}

// The host asks another simulation for advice while it is told what is wrong with this one.
TEST(Misuse, AMessageFunctionMayLoadOtherScenes) {
  sutura_options how = options();
  how.message = [](void*, std::int32_t, const char*) {
    sutura_simulation s = 0;
    EXPECT_EQ(sutura_load("/nowhere.xml", nullptr, &s), SUTURA_BAD_FILE);
    s = load_text(held_thread);
    EXPECT_EQ(sutura_step(s, 1), SUTURA_OK) << sutura_error();
    EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
  };
  const std::string text = "<sutura version='1'><A/><B/><C/></sutura>";
  sutura_simulation s = 0;
  EXPECT_EQ(sutura_load_text(text.data(), text.size(), "a.xml", nullptr, &how, &s),
            SUTURA_BAD_SCENE);
  EXPECT_EQ(sutura_diagnostic_count(), 3u);
  EXPECT_EQ(std::string(sutura_error()).substr(0, 5), "a.xml");
}

}  // namespace
}  // namespace sutura::host_tests
