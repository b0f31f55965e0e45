// Rods that lie across tools without bending round them: the force stands on the rod, so nothing
// but friction keeps it from sliding along itself, whichever of its nodes is near.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

constexpr Real g = 9.81;

std::string tilted(Real angle, const std::string& dt) {
  return "dt='" + dt + "' gravity='" + std::to_string(g * std::sin(angle)) + " 0 " +
         std::to_string(-g * std::cos(angle)) + "'";
}

/// A steel rod of 0.6 mm and 60 mm along x.
const std::string rod =
    "<plugin name='contact'/><SutureThread name='s' needle_length='0' tip='30.3 0 0 mm' "
    "tip_direction='1 0 0' plane_normal='0 1 0' thread_length='60 mm' thread_diameter='0.6 mm' "
    "thread_beams='60' thread_young='200 GPa' thread_density='7850'/>";

/// Two tools of this shape below a rod along x, this far to either side (mm). `more`: attributes of
/// the two, with NAME for that of each.
std::string two_tools(const std::string& shape, Real beside, Real below, const char* friction,
                      const std::string& more = "") {
  std::string out;
  for (const std::string name : {"a", "b"}) {
    const std::string centre =
        std::to_string(name == "a" ? -beside : beside) + " 0 " + std::to_string(-below) + " mm";
    std::string tool = "<Tool name='NAME' " + shape + " centre='" + centre + "' " + more +
                       "/><Contact name='on_NAME' tool='NAME' friction='" + friction + "'/>";
    for (std::size_t at; (at = tool.find("NAME")) != std::string::npos;) tool.replace(at, 4, name);
    out += tool;
  }
  return out;
}

/// How far it has gone along itself after this time.
Real way(TextRun& run, Real seconds) {
  const Vec3 before = run.vector("/s", "tip_position");
  run.run(seconds);
  EXPECT_EQ(run.simulation().report().missed_steps, 0);
  return run.vector("/s", "tip_position").x() - before.x();
}

/// Of what slides down, g sin(a) t^2 / 2, as implicit Euler has it.
Real free_way(Real angle, Real seconds, Real dt) {
  return g * std::sin(angle) * seconds * (seconds + dt) / 2;
}

// Where a node leans against the tool, the rod has to climb it as a bead: with touches that were
// made only where the rod was nearer by a twentieth of its radius it stood still up to 3 degrees,
// and on the edges up to 5 degrees.
TEST(RodAcrossTools, SlidesDownWithoutFriction) {
  const std::string round = "shape='cylinder' axis='0 1 0' radius='3 mm' length='20 mm'";
  const std::string edge = "shape='box' size='4 20 4 mm' rotation='0 45 0 deg'";
  for (const bool is_round : {true, false})
    for (const Real degrees : {2., 5.})
      for (const int ms : {1, 5}) {
        SCOPED_TRACE((is_round ? "bars, " : "edges, ") + std::to_string(degrees) + " degrees, " +
                     std::to_string(ms) + " ms");
        const std::string tools =
            two_tools(is_round ? round : edge, 10, is_round ? 3.3001 : 3.128528, "0");
        const Real angle = degrees * std::numbers::pi / 180;
        TextRun run(rod + tools, tilted(angle, std::to_string(ms) + " ms"));
        ASSERT_TRUE(run) << run.said();
        const Real seconds = 0.12, free = free_way(angle, seconds, 1e-3 * ms);
        // A touch leans by 0.3 % at most, which is a tenth of what draws the rod at 2 degrees; it
        // may drag or push.
        EXPECT_NEAR(way(run, seconds), free, 0.1 * free);
      }
}

// A needle of the default 12 beams on two instruments of 1 mm stood still up to 6 degrees, as with
// a friction of 0.1.
TEST(RodAcrossTools, ANeedleOnInstrumentsSlidesDown) {
  const Real angle = 6 * std::numbers::pi / 180;
  const std::string scene =
      "<plugin name='contact'/><SutureThread name='s' needle_length='26 mm' needle_angle='0' "
      "needle_diameter='0.65 mm' tip='13.3 0 0 mm' tip_direction='1 0 0' plane_normal='0 1 0' "
      "thread_length='1 mm' thread_beams='1'/>" +
      two_tools("shape='cylinder' axis='0 1 0' radius='0.5 mm' length='20 mm'", 5, 0.8251, "0");
  for (const int ms : {1, 5}) {
    TextRun run(scene, tilted(angle, std::to_string(ms) + " ms"));
    ASSERT_TRUE(run) << run.said();
    const Real free = free_way(angle, 0.1, 1e-3 * ms);
    // 0.3 % of what presses are 3 % of what draws; the needle also sags and tilts.
    EXPECT_NEAR(way(run, 0.1), free, 0.05 * free);
  }
}

// On two rollers that turn inwards friction drives a rod back to the middle: it swings with the
// period 2 pi sqrt(a / (mu g)) (a textbook's). At 5 ms it came to rest 0.75 mm off the middle, at
// 20 ms it swung with 1.9 times the period.
TEST(RodAcrossTools, SwingsOnTwoRollers) {
  const Real a = 10e-3, friction = 0.2;
  const Real half = std::numbers::pi * std::sqrt(a / (friction * g));
  std::string scene = rod;
  for (const char* one : {"name='turn_a' centre='-10", "name='turn_b' centre='10"})
    scene += std::string("<Track ") + one + " 0 -3.3001 mm' times='0 1 s' rotations='0 0 0  0 " +
             (one[11] == 'a' ? "60" : "-60") + " 0 rad'/>";
  scene += two_tools("shape='cylinder' axis='0 1 0' radius='3 mm' length='20 mm'", 10, 3.3001,
                     "0.2", "motion='turn_NAME'");
  // 2 mm off the middle.
  scene.replace(scene.find("30.3 0 0"), 8, "32.0 0 0");
  TextRun run(scene, "dt='2 ms'");
  ASSERT_TRUE(run) << run.said();
  std::vector<Real> crossings;
  Real before = 2e-3;
  while (run.simulation().time() < 0.7 - 1e-9) {
    run.simulation().step();
    const Real now = run.vector("/s", "tip_position").x() - 30e-3;
    if (now * before < 0)
      crossings.push_back(run.simulation().time() - 2e-3 * now / (now - before));
    before = now;
  }
  ASSERT_EQ(crossings.size(), 3u);
  // 0.3 % of what presses are 1.5 % of the friction, and a step is 1 % of half a period.
  EXPECT_NEAR(crossings[0], half / 2, 0.03 * half);
  for (const std::size_t i : {0, 1})
    EXPECT_NEAR(crossings[i + 1] - crossings[i], half, 0.03 * half);
}

}  // namespace
}  // namespace sutura::testing
