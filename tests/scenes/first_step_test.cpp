// The first step of a scene costs like any other: what it needs is made before, in `ready`. Counted
// per pass, because a scene that is let go takes more passes until it has come to rest.
#include <gtest/gtest.h>
#include <time.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "scenes/watched_run.h"

namespace sutura::testing {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(SUTURA_SOURCE_DIR "/scenes/suture"))
    if (entry.path().extension() == ".xml") out.push_back(entry.path().stem().string());
  std::sort(out.begin(), out.end());
  return out;
}

/// Processor time of this thread, s: other programs do not count.
double now() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

class EveryTask : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryTask, FirstPassesTakeAtMostTwiceTheMedian) {
  const fs::path file = fs::path(SUTURA_SOURCE_DIR "/scenes/suture") / (GetParam() + ".xml");
  double best = std::numeric_limits<double>::infinity();
  // Caches are still shared with other programs: the best of three counts.
  for (int attempt = 0; attempt < 3 && best > 2; ++attempt) {
    WatchedRun run(file);
    ASSERT_TRUE(run);
    std::vector<double> seconds;
    for (int i = 0; i < 41; ++i) {
      const double before = now();
      const StepReport& report = run.simulation().step();
      seconds.push_back((now() - before) / static_cast<double>(report.passes));
    }
    const double first = seconds.front();
    std::nth_element(seconds.begin(), seconds.begin() + 20, seconds.end());
    best = std::min(best, first / seconds[20]);
  }
  EXPECT_LE(best, 2);
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryTask, ::testing::ValuesIn(names()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace sutura::testing
