// A thread that is cut: what hangs on it falls, what pulled at it pulls no more, and nothing of it
// stays in the gap.
#include <gtest/gtest.h>

#include "scenes/text_run.h"
#include "sutura/end_note.h"

namespace sutura::testing {
namespace {

constexpr Real density = 910, young = 1.5e9, gravity = 9.81;  // of the thread, as by default

TEST(Scissors, WhatIsBelowFallsAndTheRestCarriesTheRest) {
  TextRun run = TextRun::file("components/Scissors.xml");
  run.run(0.1);
  EXPECT_EQ(run.number("/suture_thread", "cuts"), 0);
  const Real before = run.vector("/suture_thread", "end_position").z();
  run.run(0.3);
  EXPECT_EQ(run.number("/scissors", "cuts"), 1);
  EXPECT_EQ(run.number("/suture_thread", "cuts"), 1);
  // Implicit Euler falls h^2 g n (n + 1) / 2 in n steps, exactly; what hung there was stretched by
  // 5 nm, and is no more.
  constexpr Real h = 5e-3, n = 40;
  EXPECT_NEAR(run.vector("/suture_thread", "end_position").z(),
              before - h * h * gravity * n * (n + 1) / 2, 1e-8);
  // Twenty beams of 1 mm hang there, and half of the one that is cut; the strain is that in the
  // middle of the topmost.
  const Real strain = density * gravity * 20e-3 / young;
  EXPECT_NEAR(run.number("/suture_thread", "largest_strain"), strain, 1e-6 * strain);
  EXPECT_TRUE(run.simulation().report().solved);
}

TEST(Scissors, CutWithinAStep) {
  TextRun run = TextRun::file("components/Scissors.xml", {{"/scissors.times", "0.1023 s"}});
  run.run(0.1);
  const Real before = run.vector("/suture_thread", "end_position").z();
  run.run(0.3);
  // What is left of that step, and n whole ones. Before the cut, it hung still.
  constexpr Real h = 5e-3, rest = 2.7e-3, n = 39;
  const Real fallen = gravity * (rest * rest + n * h * rest + h * h * n * (n + 1) / 2);
  EXPECT_NEAR(run.vector("/suture_thread", "end_position").z(), before - fallen, 1e-8);
}

TEST(Scissors, SayAtTheEndThatTheyNeverCutAnything) {
  const auto note = [](const std::string& centre, const std::string& times) {
    TextRun run = TextRun::file("components/Scissors.xml",
                                {{"/scissors.centre", centre}, {"/scissors.times", times}});
    run.run(0.1);
    return dynamic_cast<const EndNote&>(*run.simulation().find("/scissors")).end_note();
  };
  const std::string beside = "50 0 -10 mm";
  EXPECT_EQ(note(beside, "20 ms"),
            "closed at 0.02 s, when their centre was at 50 0 -10 mm, and no thread was between "
            "them");
  EXPECT_EQ(note(beside, "20 40 ms").find("closed 2 times, first at 0.02 s"), 0u);
  EXPECT_EQ(note(beside, "1 s"), "");
  EXPECT_EQ(note("0 0 -10 mm", "20 40 ms"), "");
}

// 17 mm of needle and 3 mm of thread are between the blades: the thread is cut, in its middle.
TEST(Scissors, CutTheThreadBehindANeedle) {
  TextRun run(
      "<SutureThread name='a' needle_length='20 mm' needle_angle='0' thread_length='40 mm' "
      "thread_beams='40' tip_direction='-1 0 0'/><Track name='still' times='0'/>"
      "<Grasper name='holder' at='10 mm' track='still'/>"
      "<Scissors track='still' centre='13 0 0 mm' size='20 2 2 mm' times='10 ms'/>",
      "dt='5 ms' gravity='0 0 -9.81'");
  ASSERT_TRUE(run) << run.said();
  run.run(0.5);
  EXPECT_EQ(run.number("/scissors", "cuts"), 1);
  EXPECT_EQ(run.number("/a", "cuts"), 1);
  EXPECT_LT(run.vector("/a", "end_position").z(), -1.0);   // has fallen for 0.49 s
  EXPECT_GT(run.vector("/a", "tip_position").z(), -1e-3);  // is held
}

constexpr const char* between_hands =
    "<SutureThread name='a' needle_length='0' thread_length='40 mm' thread_beams='40' "
    "tip_direction='-1 0 0' damping_stiffness='0.1 ms' STRENGTH/>"
    "<Track name='still' times='0' positions='0 0 0'/><Track name='way' times='0 0.2 s' "
    "positions='0 0 0  0.8 0 0 mm'/><Grasper name='left' at='0' track='still' "
    "rotation_stiffness='0'/><Grasper name='right' at='40 mm' track='way' "
    "rotation_stiffness='0'/>";
std::string hands(const std::string& strength) {
  std::string text = between_hands;
  return text.replace(text.find("STRENGTH"), 8, strength);
}
constexpr const char* settings = "dt='5 ms' gravity='0 0 0'";

TEST(Scissors, ATautThreadPullsNoMore) {
  TextRun run(
      hands("") + "<Scissors track='still' centre='20.5 0 0 mm' size='0.6 2 2 mm' times='0.25 s'/>",
      settings);
  ASSERT_TRUE(run) << run.said();
  run.run(0.2);
  EXPECT_GT(run.vector("/left", "force").norm(), 0.5);
  run.run(0.25);
  // The halves snap back and come to rest.
  run.run(1);
  EXPECT_EQ(run.number("/a", "cuts"), 1);
  EXPECT_LT(run.vector("/left", "force").norm(), 1e-3);
  EXPECT_LT(run.vector("/right", "force").norm(), 1e-3);
  EXPECT_TRUE(run.simulation().report().solved);
}

class Tears : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Threads, Tears,
                         ::testing::Values("", "sampling_angle='0.2' shortest_beam='0.3 mm'"));

TEST_P(Tears, AtItsStrength) {
  TextRun run(hands("strength='0.3 N' " + std::string(GetParam())), settings);
  ASSERT_TRUE(run) << run.said();
  // Drawn by 2 % in 40 steps, EA = 36 N: 0.018 N more in each.
  Real most = 0;
  while (run.simulation().time() < 0.3) {
    run.simulation().step();
    most = std::max(most, run.vector("/right", "force").norm());
  }
  EXPECT_GT(most, 0.29);
  EXPECT_LT(most, 0.33);
  EXPECT_EQ(run.number("/a", "cuts"), 1);
}

TEST(Scissors, NothingTouchesWhatIsCut) {
  // A thread lies taut across another one, which is cut under it, and falls through the gap.
  const std::string two =
      "<plugin name='contact'/><SutureThread name='below' needle_length='0' tip='-20 0 0 mm' "
      "tip_direction='-1 0 0' thread_length='40 mm' thread_beams='41' clamp='both'/>"
      "<SutureThread name='above' needle_length='0' tip='0 -4 0.3 mm' tip_direction='0 -1 0' "
      "thread_length='8 mm' thread_beams='8'/><Contact first='above' second='below'/>";
  const char* falls = "dt='5 ms' gravity='0 0 -9.81'";
  TextRun held(two, falls),
      cut(two + "<Scissors body='below' size='0.5 2 2 mm' times='0.1 s'/>", falls);
  ASSERT_TRUE(held && cut) << held.said() << cut.said();
  held.run(0.3);
  cut.run(0.3);
  EXPECT_GT(held.vector("/above", "tip_position").z(), -2e-3);
  EXPECT_LT(cut.vector("/above", "tip_position").z(), -50e-3);
}

TEST(Scissors, WhatIsCutIsOnNeitherSideOfAPlane) {
  // A plane bounds a half space, and no place is far from all half spaces.
  for (const char* axis : {"0 0 1", "1 1 1", "-1 -1 1", "-0.3 0.2 0.5"}) {
    TextRun run(
        "<plugin name='contact'/><SutureThread needle_length='0' tip='-20 0 0 mm' "
        "tip_direction='-1 0 0' thread_length='40 mm' thread_beams='41' clamp='both'/>"
        "<Tool shape='plane' centre='0 0 -40 mm' axis='" +
        std::string(axis) + "'/><Contact tool='tool'/><Scissors size='0.5 2 2 mm' times='0'/>");
    ASSERT_TRUE(run) << run.said();
    run.run(0.05);
    EXPECT_EQ(run.number("/suture_thread", "cuts"), 1);
    EXPECT_EQ(run.vector("/tool", "force").norm(), 0) << axis;
    EXPECT_GT(run.number("/contact", "distance"), 0) << axis;
    EXPECT_TRUE(run.simulation().report().solved) << axis;
  }
}

TEST(Scissors, TheEndsOfACutLieOnWhatIsBelow) {
  // Both halves fall on a table, or on tissue as wide as they are long, and lie there.
  const std::string thread =
      "<plugin name='contact'/><SutureThread name='a' needle_length='0' tip='-5 0.1 0.2 mm' "
      "tip_direction='-1 0 0' thread_length='10 mm' thread_beams='11' thread_diameter='0.2 mm' "
      "damping_mass='20 1/s'/><Scissors size='0.5 2 2 mm' times='0'/>"
      "<ThreadProbe name='left' at='4.5454545 mm'/><ThreadProbe name='right' at='5.4545455 mm'/>";
  for (const char* below :
       {"<Tool shape='plane'/><Contact first='/a' tool='tool' friction='0'/>",
        "<Tool shape='box' size='20 20 2 mm' centre='0 0 -1 mm'/><Contact first='/a' tool='tool'/>",
        "<BlockMesh box='-8 -4 -4  8 4 0 mm' cells='8 4 2'/><Tissue young='100 kPa' "
        "poisson='0.3'/><Attach box='-8 -4 -4  8 4 -4 mm'/><Contact first='/a' "
        "second='/tissue'/>"}) {
    TextRun run(thread + below, "dt='5 ms' gravity='0 0 -9.81'");
    ASSERT_TRUE(run) << run.said();
    run.run(1);
    EXPECT_EQ(run.number("/a", "cuts"), 1);
    // The ends beside the cut are as high as the radius, as the others.
    for (const char* end : {"/left", "/right"})
      EXPECT_NEAR(run.vector(end, "position").z(), 0.1e-3, 3e-6) << end << below;
    EXPECT_NEAR(run.number("/contact", "distance"), 0, 3e-6) << below;
    EXPECT_TRUE(run.simulation().report().solved) << below;
  }
}

TEST(Scissors, TheHalvesTouchEachOther) {
  // The halves lie along one line. One is let fall on the other, which a hand holds, and lies on
  // it: without a cut nothing of a straight thread would touch itself.
  TextRun run(
      "<plugin name='contact'/><SutureThread name='a' needle_length='0' tip='-10 0 0 mm' "
      "tip_direction='-1 0 0' thread_length='20 mm' thread_beams='41' thread_diameter='0.2 mm' "
      "thread_young='10 GPa' damping_mass='20 1/s'/><Scissors track='still' size='0.4 2 2 mm' "
      "times='0'/>"
      "<Track name='way' times='0 0.2 0.4 s' positions='0 0 0  0 0 1  -5 0 1 mm'/>"
      "<Track name='still' times='0' positions='0 0 0'/>"
      "<Grasper name='left' at='5 mm' track='still'/>"
      "<Grasper name='right' at='15 mm' track='way' release='0.4 s'/>"
      "<Contact first='/a' friction='0.5'/>",
      "dt='2 ms' gravity='0 0 -9.81'");
  ASSERT_TRUE(run) << run.said();
  run.run(0.6);
  EXPECT_GT(run.number("/contact", "touches"), 0);
  EXPECT_NEAR(run.number("/contact", "distance"), 0, 3e-6);
}

}  // namespace
}  // namespace sutura::testing
