// The first step of a scene costs like any other: what it needs is made before, in `ready`. Counted
// per pass, because a scene that is let go takes more passes until it has come to rest.
#include <gtest/gtest.h>
#include <time.h>

#include <algorithm>
#include <limits>

#include "scenes/suture_tasks.h"
#include "scenes/watched_run.h"

namespace sutura::testing {
namespace {

/// Processor time of this thread, s: other programs do not count.
double now() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

class EveryTask : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryTask, FirstPassesTakeAtMostTwiceTheMedian) {
  double best = std::numeric_limits<double>::infinity();
  // Caches are still shared with other programs: the best of three counts.
  for (int attempt = 0; attempt < 3 && best > 2; ++attempt) {
    WatchedRun run(suture_task(GetParam()));
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

INSTANTIATE_TEST_SUITE_P(Scenes, EveryTask, ::testing::ValuesIn(suture_tasks()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace sutura::testing
