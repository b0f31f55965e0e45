// When the jaws are closed.
#include "grasp_schedule.h"

#include <gtest/gtest.h>

#include <limits>

namespace sutura::tools {
namespace {

TEST(GraspSchedule, CountsEventsUpToNow) {
  const GraspSchedule s({0, 2}, {1});
  EXPECT_EQ(s.events_until(-0.1, 0), 0);
  EXPECT_EQ(s.events_until(0, 0), 1);
  EXPECT_EQ(s.events_until(0.99, 0), 1);
  EXPECT_EQ(s.events_until(1, 0), 2);
  EXPECT_EQ(s.events_until(2, 0), 3);
  EXPECT_EQ(s.events_until(100, 0), 3);
}

TEST(GraspSchedule, SlackForgivesTheRoundingOfTheClock) {
  const GraspSchedule s({0.3}, {});
  const Real sum = 0.1 + 0.1 + 0.1 - 1e-15;
  EXPECT_EQ(s.events_until(sum, 0), 0);
  EXPECT_EQ(s.events_until(sum, 1e-8), 1);
}

TEST(GraspSchedule, SaysWhatComesNext) {
  const GraspSchedule s({0.2, 2}, {1});
  EXPECT_EQ(s.next_after(-1), 0.2);
  EXPECT_EQ(s.next_after(0.2), 1);
  EXPECT_EQ(s.next_after(1.5), 2);
  EXPECT_EQ(s.next_after(2), std::numeric_limits<Real>::infinity());
}

TEST(GraspSchedule, CheckSaysWhatIsWrong) {
  const auto check = GraspSchedule::check;
  EXPECT_EQ(check({0}, {}), "");
  EXPECT_EQ(check({0}, {1}), "");
  EXPECT_EQ(check({0, 2}, {1}), "");
  EXPECT_NE(check({}, {}).find("at least one"), std::string::npos);
  EXPECT_NE(check({0}, {1, 2}).find("release"), std::string::npos);
  EXPECT_NE(check({0, 1, 2}, {0.5}).find("3 times of grasp"), std::string::npos);
  EXPECT_NE(check({1}, {0.5}).find("release at 0.5 s"), std::string::npos);
  EXPECT_NE(check({0, 1}, {1.5}).find("grasp at 1 s"), std::string::npos);
  EXPECT_NE(check({0}, {0}).find("not after"), std::string::npos);
}

}  // namespace
}  // namespace sutura::tools
