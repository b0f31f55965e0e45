// Two threads pulled taut across each other do not pass through each other, whatever the step:
// judged by what crosses what, not by the code that prevents it.
#include <gtest/gtest.h>

#include "contact_scenes.h"
#include "scenes/text_run.h"
#include "stability/contact/crossings.h"

namespace sutura::testing {
namespace {

constexpr Real r = 0.1e-3;
const char* const steps[] = {"1 ms", "5 ms", "10 ms", "20 ms", "50 ms"};

/// Runs and counts how often the two (or one with itself) have gone through each other.
int run(TextRun& world, const std::string& a, const std::string& b, Real seconds) {
  const auto& first = world.component<SegmentedCurve>(a);
  const auto& second = world.component<SegmentedCurve>(b);
  int count = 0;
  Line a0 = line_of(first), b0 = line_of(second);
  while (world.simulation().time() < seconds - 1e-9) {
    EXPECT_TRUE(world.simulation().step().finite);
    const Line a1 = line_of(first), b1 = line_of(second);
    count += crossings(a0, a1, b0, b1, a == b);
    a0 = a1, b0 = b1;
  }
  return count;
}

// The judge sees a crossing where there is one: no contact, and the thread flies through the other.
TEST(NoCrossing, TheJudgeSeesOne) {
  TextRun world(
      "<plugin name='contact'/>" +
          thread("a", Vec3(0.13e-3, 0.21e-3, 3e-3), Vec3::UnitY(), 0.02, 20, "velocity='0 0 -5'") +
          thread("b", Vec3::Zero(), Vec3::UnitX(), 0.06, 60, "clamp='both'"),
      "dt='10 ms' gravity='0 0 0'");
  ASSERT_TRUE(world) << world.said();
  EXPECT_EQ(run(world, "/a", "/b", 0.02), 1);
}

class NoCrossingAt : public ::testing::TestWithParam<const char*> {};

// Two threads crossed at a right angle, pulled against each other by hands until they are taut.
TEST_P(NoCrossingAt, TautAcrossEachOther) {
  const std::string ends =
      "<Track name='down' times='0 0.1 s' positions='0 0 0  0 0 -5 mm'/><Track name='rest' "
      "times='0'/><Grasper name='a0' body='a' track='down' at='0' rotation_stiffness='0'/>"
      "<Grasper name='a1' body='a' track='down' at='20 mm' rotation_stiffness='0'/>"
      "<Grasper name='b0' body='b' track='rest' at='0' rotation_stiffness='0'/>"
      "<Grasper name='b1' body='b' track='rest' at='20 mm' rotation_stiffness='0'/>";
  for (const char* friction : {"0", "0.3"}) {
    TextRun world("<plugin name='contact'/>" +
                      thread("a", Vec3(0, 0, 1.05 * r), Vec3::UnitX(), 0.02, 20, "") +
                      thread("b", Vec3(0, 0, -1.05 * r), Vec3::UnitY(), 0.02, 20, "") + ends +
                      "<Contact first='a' second='b' friction='" + friction + "'/>",
                  std::string("dt='") + GetParam() + "' gravity='0 0 0'");
    ASSERT_TRUE(world) << world.said();
    EXPECT_EQ(run(world, "/a", "/b", 0.2), 0) << friction;
    // And they hold each other: pulled 5 mm apart, the threads are strained by 3 %.
    EXPECT_GT(world.vector("/a0", "force").norm(), 0.3) << friction;
  }
}

INSTANTIATE_TEST_SUITE_P(AtAnyStep, NoCrossingAt, ::testing::ValuesIn(steps));

}  // namespace
}  // namespace sutura::testing
