// What moves by itself, a tool on a track or tissue that is carried, does not wait for what is in
// its way: it takes it along, or the step says that it has gone through. Never in silence.
#include <gtest/gtest.h>

#include "contact_scenes.h"
#include "scenes/text_run.h"
#include "stability/contact/crossings.h"

namespace sutura::testing {
namespace {

const char* const at_5_m_per_s = "times='0 0.2 s' positions='0 0 0  0 0 1'";

class Swept : public ::testing::TestWithParam<const char*> {
 protected:
  std::string settings() const { return std::string("dt='") + GetParam() + "' gravity='0 0 0'"; }
  /// Steps until `seconds`; false if one of them said that it cannot be trusted.
  static bool runs_without_a_word(TextRun& run, Real seconds) {
    bool silent = true;
    while (run.simulation().time() < seconds - 1e-9) {
      const StepReport& report = run.simulation().step();
      EXPECT_TRUE(report.finite);
      silent = silent && report.solved && report.faults.empty();
    }
    return silent;
  }
};

// In steps of 50 ms the bar is 250 mm further at once: then the thread may slip off round it, which
// is said. It may turn about the bar; it is taken along, and never comes through.
TEST_P(Swept, ABarTakesAThreadAlong) {
  TextRun run("<plugin name='contact'/>" + thread("a", Vec3::Zero(), Vec3::UnitX(), 0.02, 20, "") +
                  "<Track name='go' " + at_5_m_per_s +
                  "/><Tool name='bar' shape='cylinder' axis='0 1 0' radius='1 mm' length='30 mm' "
                  "centre='0.3 0 -20 mm' motion='go'/><Contact tool='bar' friction='0.3'/>",
              settings());
  ASSERT_TRUE(run) << run.said();
  const auto& a = run.component<SegmentedCurve>("/a");
  // Seen from the bar, whose axis is along y.
  const auto seen = [&] {
    Line line = line_of(a);
    for (Vec3& p : line) p -= run.vector("/bar", "position");
    return line;
  };
  const Line axis{Vec3(0, -0.05, 0), Vec3(0, 0.05, 0)};
  bool silent = true;
  while (run.simulation().time() < 0.1 - 1e-9 && silent) {
    const Line before = seen();
    silent = runs_without_a_word(run, run.simulation().time() + 1e-6);
    if (silent) {
      EXPECT_EQ(crossings(before, seen(), axis, axis, false), 0) << run.simulation().time();
      EXPECT_GT(run.number("/contact", "distance"), -1e-5);
    }
  }
  if (run.simulation().scene().dt < 0.02) {
    EXPECT_TRUE(silent);
    EXPECT_LT(seen()[0].norm(), 40e-3);  // within two lengths of it, after half a metre
  }
}

// A bar thinner than the way between the places at which a beam is looked at, beside a node.
TEST_P(Swept, ABarAsThinAsTheThreadTakesItAlong) {
  for (const Real beside : {0., 0.1e-3, 0.5e-3}) {
    TextRun run("<plugin name='contact'/>" +
                    thread("a", Vec3(beside, 0, 0), Vec3::UnitX(), 0.02, 10, "") +
                    "<Track name='go' times='0 10 s' positions='0 0 0  0 0 1'/><Tool name='bar' "
                    "shape='capsule' axis='0 1 0' radius='0.02 mm' length='30 mm' centre='0 0 "
                    "-1 mm' motion='go'/><Contact tool='bar'/>",
                settings());
    ASSERT_TRUE(run) << run.said();
    EXPECT_TRUE(runs_without_a_word(run, 0.1));
    EXPECT_GT(run.number("/contact", "distance"), -1e-5) << beside;
    EXPECT_GT(run.vector("/a", "tip_position").z(), 5e-3) << beside;
  }
}

// A thread that cannot give way is torn or gone through; both are said.
TEST_P(Swept, AThreadThatIsHeldDoesNotLetABarThroughInSilence) {
  TextRun run("<plugin name='contact'/>" +
                  thread("a", Vec3::Zero(), Vec3::UnitX(), 0.02, 20, "clamp='both'") +
                  "<Track name='go' " + at_5_m_per_s +
                  "/><Tool name='bar' shape='cylinder' axis='0 1 0' radius='1 mm' length='30 mm' "
                  "centre='0 0 -20 mm' motion='go'/><Contact tool='bar' friction='0.3'/>",
              settings());
  ASSERT_TRUE(run) << run.said();
  EXPECT_FALSE(runs_without_a_word(run, 0.05));
}

TEST_P(Swept, CarriedTissueTakesAThreadAlong) {
  TextRun run("<plugin name='contact'/>" +
                  thread("a", Vec3(0.7e-3, 0.3e-3, 4.1e-3), Vec3::UnitX(), 8e-3, 8, "") +
                  block("skin", "-10 -5 -8 10 5 0", "6 4 4",
                        std::string("<Track name='hand' ") + at_5_m_per_s +
                            "/><Attach box='-10 -5 -8 10 5 0 mm' motion='hand'/>") +
                  "<Contact first='a' second='/skin/tissue'/>",
              settings());
  ASSERT_TRUE(run) << run.said();
  EXPECT_TRUE(runs_without_a_word(run, 0.1));
  EXPECT_GT(run.vector("/a", "tip_position").z(), run.simulation().time() * 5);
}

// The block is held all round: what is not said to be gone through has to be below the ball.
TEST_P(Swept, ABallDoesNotGoThroughTissueInSilence) {
  TextRun run("<plugin name='contact'/>" +
                  block("skin", "-10 -10 -4 10 10 0", "5 5 2",
                        "<Attach name='w' box='-10 -10 -4 -10 10 0 mm'/>"
                        "<Attach name='e' box='10 -10 -4 10 10 0 mm'/>"
                        "<Attach name='s' box='-10 -10 -4 10 -10 0 mm'/>"
                        "<Attach name='n' box='-10 10 -4 10 10 0 mm'/>") +
                  "<Track name='go' times='0 0.2 s' positions='0 0 0  0 0 -1'/><Tool name='ball' "
                  "shape='sphere' radius='2 mm' centre='1 2 20 mm' motion='go'/>"
                  "<Contact first='/skin/tissue' tool='ball'/>",
              settings());
  ASSERT_TRUE(run) << run.said();
  bool silent = true;
  while (run.simulation().time() < 0.05 - 1e-9 && silent) {
    silent = runs_without_a_word(run, run.simulation().time() + 1e-6);
    Real lowest = 1;
    for (const Vec3& p : run.component<Body>("/skin/tissue").geometry().points)
      lowest = std::min(lowest, p.z());
    EXPECT_TRUE(!silent || lowest < run.vector("/ball", "position").z() - 2e-3);
  }
}

// Two blocks, 5 mm apart, are brought together by 6 mm with up to 5 m/s: they come to rest pressed
// by 1 mm, whatever the step.
TEST_P(Swept, TwoBlocksMeetAtAnySpeed) {
  for (const Real speed : {0.1, 1., 5.}) {
    TextRun run(
        "<plugin name='contact'/>" +
            block("left", "-10 -5 -5 0 5 5", "4 4 4", "<Attach box='-10 -5 -5 -10 5 5 mm'/>") +
            block("right", "5 -5 -5 15 5 5", "3 3 3",
                  "<Track name='hand' times='0 " + std::to_string(6e-3 / speed) +
                      " s' positions='0 0 0 -6 0 0 mm'/><Attach box='15 -5 -5 15 5 5 mm' "
                      "motion='hand'/>") +
            "<Contact first='/left/tissue' second='/right/tissue' friction='0'/>",
        settings());
    ASSERT_TRUE(run) << run.said();
    EXPECT_NEAR(run.number("/contact", "distance"), 5e-3, 1e-12);
    EXPECT_TRUE(runs_without_a_word(run, 0.3)) << speed;
    // At least as a bar of 20 mm pressed by 1 mm without friction; at most with both ends glued,
    // where nothing can go aside: (1 - nu) / ((1 + nu) (1 - 2 nu)) = 1.35 times that.
    const Real bar = 20e3 * 100e-6 * 1e-3 / 20e-3, force = -run.vector("/contact", "force").x();
    EXPECT_GT(force, bar) << speed;
    EXPECT_LT(force, 1.35 * bar) << speed;
    EXPECT_GT(run.number("/contact", "distance"), -1e-6);
  }
}

// Two bars crossed, with no node where they meet: their edges hold them apart.
TEST_P(Swept, CrossedEdgesDoNotGoThrough) {
  TextRun run("<plugin name='contact'/>" +
                  block("low", "-15 -2 -4 15 2 0", "3 1 1",
                        "<Attach name='a' box='-15 -2 -4 -15 2 0 mm'/>"
                        "<Attach name='b' box='15 -2 -4 15 2 0 mm'/>") +
                  block("high", "-2 -15 0.1 2 15 4.1", "1 3 1",
                        "<Track name='hand' times='0 0.5 s' positions='0 0 0 0 0 -3 mm'/>"
                        "<Attach box='-2 -15 0.1 2 15 4.1 mm' motion='hand'/>") +
                  "<Contact first='/low/tissue' second='/high/tissue'/>",
              settings());
  ASSERT_TRUE(run) << run.said();
  EXPECT_TRUE(runs_without_a_word(run, 0.5));
  EXPECT_GT(run.number("/contact", "distance"), -1e-6);  // the tolerance of gaps
}

INSTANTIATE_TEST_SUITE_P(AtAnyStep, Swept, ::testing::Values("1 ms", "10 ms", "50 ms"));

}  // namespace
}  // namespace sutura::testing
