// Every misuse has a status and a sentence. Random calls in random order find what nobody thought
// of.
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>

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

/// Calls with arguments that are right, nearly right and wrong.
class RandomHost {
 public:
  explicit RandomHost(std::uint64_t seed) : random_(seed) {
    for (std::string file : {"components/Grasper.xml", "components/Track.xml",
                             "components/CsvProbe.xml", "components/GaussSeidel.xml"})
      files_.push_back(scenes + file);
    files_.emplace_back("/nowhere.xml");
  }
  ~RandomHost() {
    for (const sutura_simulation s : simulations_) sutura_destroy(s);
  }

  /// True if the status is one that the API has, with a sentence if it is an error.
  bool call() {
    const sutura_status status = one();
    ++(status == SUTURA_OK ? right_ : wrong_);
    const bool known = (status >= SUTURA_OK && status <= SUTURA_NO_MEMORY && status != 5);
    return known && (status == SUTURA_OK || sutura_error()[0] != 0);
  }

  long right() const { return right_; }
  long wrong() const { return wrong_; }

 private:
  std::size_t below(std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_);
  }
  bool chance(int percent) { return below(100) < static_cast<std::size_t>(percent); }
  /// A handle: of what was asked for, of something else, or made up.
  std::uint64_t pick(const std::vector<std::uint64_t>& right) {
    if (!right.empty() && chance(90)) return right[below(right.size())];
    if (!all_.empty() && chance(80)) return all_[below(all_.size())] + (chance(20) ? below(9) : 0);
    return chance(50) ? random_() : 0;
  }
  double number() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    const std::array<double, 8> some{0, 1, -1, 1e-3, 1e300, inf, std::nan(""), 5e-324};
    return chance(97) ? 1e-3 * static_cast<double>(below(20)) : some[below(some.size())];
  }
  const char* name() {
    constexpr std::array<const char*, 10> names{"/grasper.hold",
                                                "/track.position",
                                                "/grasper.force",
                                                "/track",
                                                "/suture",
                                                "",
                                                ".",
                                                "/nothing.at",
                                                "....",
                                                "/track.rotation"};
    return names[below(names.size())];
  }
  sutura_status keep(sutura_status status, std::uint64_t handle, std::vector<std::uint64_t>& in) {
    if (status != SUTURA_OK) return status;
    constexpr std::size_t most = 8;  // so that few are of simulations long gone
    if (in.size() >= most)
      in[below(most)] = handle;
    else
      in.push_back(handle);
    if (all_.size() >= most)
      all_[below(most)] = handle;
    else
      all_.push_back(handle);
    return status;
  }

  sutura_status load() {
    sutura_options how = options();
    if (chance(5)) how.struct_size = static_cast<std::uint32_t>(random_());
    if (chance(5)) how.api = 0;
    if (how.struct_size >= sizeof how) how.struct_size = sizeof how;
    sutura_simulation s = 0;
    const sutura_status status =
        sutura_load(files_[below(files_.size())].c_str(), chance(50) ? &how : nullptr, &s);
    if (status != SUTURA_OK) return status;
    constexpr std::size_t most = 5;
    if (simulations_.size() >= most) {
      sutura_destroy(simulations_[0]);  // refused if an earlier call has done it already
      simulations_.erase(simulations_.begin());
    }
    return keep(status, s, simulations_);
  }
  sutura_status one();
  sutura_status query(sutura_simulation s);

  std::mt19937_64 random_;
  long right_ = 0, wrong_ = 0;
  std::vector<std::string> files_;
  std::vector<std::uint64_t> all_, simulations_, inputs_, outputs_, bodies_, tools_;
  std::vector<std::byte> saved_;
};

sutura_status RandomHost::query(sutura_simulation s) {
  std::uint64_t out = 0;
  std::size_t count = 0;
  const std::size_t which = below(chance(80) ? 3 : 30);
  switch (below(13)) {
    case 0:
      return keep(sutura_find_input(s, name(), &out), out, inputs_);
    case 1:
      return keep(sutura_find_output(s, name(), &out), out, outputs_);
    case 2:
      return keep(sutura_find_body(s, name(), &out), out, bodies_);
    case 3:
      return keep(sutura_find_tool(s, name(), &out), out, tools_);
    case 4:
      return keep(sutura_input_at(s, which, &out), out, inputs_);
    case 5:
      return keep(sutura_output_at(s, which, &out), out, outputs_);
    case 6:
      return keep(sutura_body_at(s, which, &out), out, bodies_);
    case 7:
      return keep(sutura_tool_at(s, which, &out), out, tools_);
    case 8:
      return sutura_component_count(s, chance(90) ? &count : nullptr);
    case 9: {
      sutura_component c{};
      c.struct_size = chance(90) ? sizeof c : 3;
      return sutura_component_at(s, which, &c);
    }
    case 10: {
      const char* xml = nullptr;
      return sutura_write_scene(s, &xml);
    }
    case 11:
      return sutura_start_recording(0);
    default: {
      sutura_report r{};
      r.struct_size = chance(90) ? sizeof r : 0;
      return sutura_get_report(s, &r);
    }
  }
}

sutura_status RandomHost::one() {
  const sutura_simulation s = pick(simulations_);
  const std::array<double, 7> values{number(), number(), number(), 1, 0, 0, 0};
  std::array<double, 7> results{};
  sutura_value value{};
  value.struct_size = sizeof value;
  switch (below(100)) {
    case 0:
      return simulations_.empty() || chance(20) ? load() : query(s);
    case 1:
      return sutura_reset(s);
    case 2: {
      const void* data = nullptr;
      std::size_t size = 0;
      const sutura_status status = sutura_save(s, &data, &size);
      const auto* bytes = static_cast<const std::byte*>(data);
      if (status == SUTURA_OK) saved_.assign(bytes, bytes + size);
      return status;
    }
    case 3:
      if (!saved_.empty() && chance(20)) saved_[below(saved_.size())] ^= std::byte{64};
      return sutura_restore(s, saved_.data(), saved_.size());
    case 4:
      return chance(5) ? sutura_destroy(chance(50) ? pick(all_) : s) : query(s);
    case 5:
    case 6:
    case 7:
    case 8:
    case 9:
      return sutura_step(s, below(3));
    default:
      break;
  }
  switch (below(15)) {
    case 0:
    case 1:
      return sutura_set_input(pick(inputs_), chance(97) ? values.data() : nullptr,
                              1 + 2 * below(2));
    case 2:
    case 3:
      return sutura_get_output(pick(outputs_), results.data(),
                               chance(90) ? 1 + 2 * below(2) : below(7));
    case 4:
      return sutura_set_pose(pick(tools_), values.data());
    case 5:
      return sutura_get_pose(pick(tools_), results.data());
    case 6: {
      sutura_geometry g{};
      g.struct_size = sizeof g;
      const sutura_status status = sutura_get_geometry(pick(bodies_), &g);
      double sum = 0;
      for (std::size_t i = 0; i < 3 * g.point_count; ++i) sum += g.points[i];
      EXPECT_TRUE(std::isfinite(sum) || status == SUTURA_OK);
      return status;
    }
    case 7: {
      sutura_field f{};
      f.struct_size = sizeof f;
      return sutura_get_field(pick(bodies_), below(9), &f);
    }
    case 8: {
      const char* text = nullptr;
      if (chance(30)) return sutura_get_text(pick(outputs_), &text);
      return chance(50) ? sutura_describe_input(pick(inputs_), &value)
                        : sutura_describe_output(pick(outputs_), &value);
    }
    default:
      return query(s);
  }
}

TEST(Misuse, RandomCallsInRandomOrder) {
  long calls = 100000;
  std::uint64_t seed = 20261122;
  if (const char* more = std::getenv("SUTURA_TEST_CALLS")) calls = std::atol(more);
  if (const char* other = std::getenv("SUTURA_TEST_SEED")) seed = std::strtoull(other, nullptr, 10);
  RandomHost host(seed);
  for (long i = 0; i < calls; ++i)
    ASSERT_TRUE(host.call()) << "call " << i << ": " << sutura_error();
  // Neither all refused nor all well.
  EXPECT_GT(host.right(), calls / 10);
  EXPECT_GT(host.wrong(), calls / 10);
}

}  // namespace
}  // namespace sutura::host_tests
