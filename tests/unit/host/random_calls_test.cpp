// Random calls in random order find what nobody thought of: no crash, and every misuse has a status
// and a sentence.
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>

#include "house/command.h"
#include "unit/host/loaded.h"

namespace sutura::host_tests {
namespace {

/// Calls with arguments that are right, nearly right and wrong.
class RandomHost {
 public:
  explicit RandomHost(std::uint64_t seed) : random_(seed) {
    for (std::string file :
         {"components/Grasper.xml", "components/Track.xml", "components/CsvProbe.xml",
          "components/GaussSeidel.xml", "components/AsyncPreconditioner.xml"})
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

  /// A scene of which an end is missing, or a byte is another one; or not.
  sutura_status load_damaged(const sutura_options& how, sutura_simulation& s) {
    std::string text = held_thread;
    if (chance(30)) text.resize(below(text.size()));
    if (chance(30) && !text.empty()) text[below(text.size())] = static_cast<char>(random_());
    return sutura_load_text(text.data(), text.size(), chance(50) ? "a.xml" : nullptr, nullptr, &how,
                            &s);
  }
  /// A pool that does it now, later, twice, or never.
  static void enqueue(void* pool, sutura_job job, void* data) {
    auto& self = *static_cast<RandomHost*>(pool);
    if (self.chance(50)) job(data);
    self.job_ = job;
    self.data_ = data;
  }

  sutura_status load() {
    sutura_options how = options();
    if (chance(5)) how.struct_size = static_cast<std::uint32_t>(random_());
    if (chance(5)) how.api = 0;
    if (how.struct_size >= sizeof how) how.struct_size = sizeof how;
    sutura_simulation s = 0;
    const std::string output = (folder_.path() / (chance(50) ? "a" : "b")).string();
    how.output = output.c_str();
    how.pool = this;
    if (chance(50)) how.enqueue = &enqueue;
    const bool as_text = chance(20);
    const std::string& file = files_[below(files_.size())];
    const sutura_status status =
        as_text ? load_damaged(how, s) : sutura_load(file.c_str(), chance(90) ? &how : nullptr, &s);
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
  sutura_status files(sutura_simulation s);

  std::mt19937_64 random_;
  long right_ = 0, wrong_ = 0;
  std::vector<std::string> files_;
  std::vector<std::uint64_t> all_, simulations_, inputs_, outputs_, bodies_, tools_;
  std::vector<std::byte> saved_;
  sutura_job job_ = nullptr;  ///< the last that a pool was given
  void* data_ = nullptr;
  house::TemporaryFolder folder_{"random_calls"};
};

sutura_status RandomHost::files(sutura_simulation s) {
  const std::string file = (folder_.path() / (chance(90) ? "state" : "no/../state")).string();
  if (chance(10) && job_ != nullptr) job_(chance(80) ? data_ : this);
  switch (below(6)) {
    case 0:
      return sutura_start_recording(s);
    case 1:
      return sutura_resume_recording(s);
    case 2:
    case 3:
      return sutura_finish_recording(s);
    case 4:
      return sutura_save_file(s, chance(90) ? file.c_str() : folder_.path().c_str());
    default:
      return sutura_restore_file(s, chance(90) ? file.c_str() : "/nowhere/state");
  }
}

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
    case 11: {
      sutura_diagnostic d{};
      d.struct_size = chance(90) ? sizeof d : 1;
      return sutura_diagnostic_at(below(3), &d);
    }
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
      return chance(5) ? sutura_destroy(chance(50) ? pick(all_) : s) : files(s);
    case 5:  // seldom: a step takes as long as thousands of other calls
      return chance(25) ? sutura_step(s, below(3)) : query(s);
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

TEST(RandomCalls, InRandomOrder) {
  long calls = 100000;
  std::uint64_t seed = 20261122;
  if (const char* more = std::getenv("SUTURA_TEST_CALLS")) calls = std::atol(more);
  if (const char* other = std::getenv("SUTURA_TEST_SEED")) seed = std::strtoull(other, nullptr, 10);
  RandomHost host(seed);
  for (long i = 0; i < calls; ++i)
    ASSERT_TRUE(host.call()) << "call " << i << ": " << sutura_error();
  RecordProperty("right", std::to_string(host.right()));
  RecordProperty("wrong", std::to_string(host.wrong()));
  // Neither all refused nor all well.
  EXPECT_GT(host.right(), calls / 10);
  EXPECT_GT(host.wrong(), calls / 10);
}

}  // namespace
}  // namespace sutura::host_tests
