// Nothing passes through anything, whatever the step and the speed: judged by the Gauss integral
// and by where things are, not by the code that prevents it.
#include <gtest/gtest.h>

#include <random>

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
  TextRun world("<plugin name='contact'/>" +
                    thread("a", Vec3(0, 0, 3e-3), Vec3::UnitY(), 0.02, 20, "velocity='0 0 -5'") +
                    thread("b", Vec3::Zero(), Vec3::UnitX(), 0.06, 60, "clamp='both'"),
                "dt='10 ms' gravity='0 0 0'");
  ASSERT_TRUE(world) << world.said();
  EXPECT_EQ(run(world, "/a", "/b", 0.02), 1);
}

class Shot : public ::testing::TestWithParam<const char*> {};

// At 5 m/s at a thread that is held at its ends, at any angle and place.
TEST_P(Shot, AThreadAtAThread) {
  std::mt19937 random(7);
  std::uniform_real_distribution<Real> part(0, 1);
  for (int seed = 0; seed < 3; ++seed) {
    const Real angle = 0.3 + 2.5 * part(random);
    const Vec3 along(std::cos(angle), std::sin(angle), 0);
    const Vec3 middle(0.02 * part(random) - 0.01, 0.01 * part(random) - 0.005,
                      1e-3 + 0.03 * part(random));
    TextRun world("<plugin name='contact'/>" +
                      thread("a", middle, along, 0.02, 20, "velocity='0 0 -5'") +
                      thread("b", Vec3::Zero(), Vec3::UnitX(), 0.06, 60, "clamp='both'") +
                      "<Contact first='a' second='b' friction='0.2'/>",
                  std::string("dt='") + GetParam() + "' gravity='0 0 0'");
    ASSERT_TRUE(world) << world.said();
    EXPECT_EQ(run(world, "/a", "/b", 0.05), 0) << seed;
  }
}

// At a bar as thick as five threads: no point of the thread is ever inside of it.
TEST_P(Shot, AThreadAtATool) {
  std::mt19937 random(11);
  std::uniform_real_distribution<Real> part(0, 1);
  for (int seed = 0; seed < 3; ++seed) {
    const Real angle = 0.3 + 2.5 * part(random);
    const Vec3 along(std::cos(angle), std::sin(angle), 0);
    const Vec3 middle(0.02 * part(random) - 0.01, 0.01 * part(random) - 0.005,
                      2e-3 + 0.03 * part(random));
    TextRun world("<plugin name='contact'/>" +
                      thread("a", middle, along, 0.02, 20, "velocity='0 0 -5'") +
                      "<Tool name='bar' shape='cylinder' axis='1 0 0' radius='0.5 mm' "
                      "length='200 mm'/><Contact tool='bar' friction='0.2'/>",
                  std::string("dt='") + GetParam() + "' gravity='0 0 0'");
    ASSERT_TRUE(world) << world.said();
    while (world.simulation().time() < 0.05 - 1e-9) {
      EXPECT_TRUE(world.simulation().step().finite);
      // Gone past the bar on both sides, it has wound round it or slid off; never half way in.
      for (const Vec3& p : line_of(world.component<SegmentedCurve>("/a")))
        EXPECT_GT(std::hypot(p.y(), p.z()), 0.5e-3 + r / 4) << seed;
    }
  }
}

// Two threads crossed at a right angle, pulled against each other by hands until they are taut.
TEST_P(Shot, TautAcrossEachOther) {
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

INSTANTIATE_TEST_SUITE_P(AtAnyStep, Shot, ::testing::ValuesIn(steps));

}  // namespace
}  // namespace sutura::testing
