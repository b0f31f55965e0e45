// At the mouth of a channel: what is inside is held by the channel, what is outside lies on the
// skin.
#include <gtest/gtest.h>

#include "contact_scenes.h"
#include "scenes/text_run.h"
#include "sutura/geometry/curve_segments.h"

namespace sutura::testing {
namespace {

const std::string on_skin =
    "<plugin name='contact'/><Contact first='suture' second='/skin/tissue'/>";

/// The first 1.6 s of scenes/suture/first_stitch.xml: in at one side, out at the other.
TextRun pricked(const std::string& more) {
  TextRun run(R"(<node name="skin">
    <TetMesh file="../meshes/pad.msh" unit="mm"/><AsyncPreconditioner lag="3"/>
    <Tissue name="tissue" young="20 kPa" poisson="0.45" density="1000" damping_stiffness="10 ms"/>
    <Layer region="dermis" young="100 kPa"/><Attach box="-25 -15 -10  25 15 -10 mm"/></node>
    <SutureThread name="suture" needle_length="26 mm" needle_angle="180 deg"
      needle_diameter="0.65 mm" tip="-7.374 0 1.243 mm" tip_direction="0.454 0 -0.891"
      plane_normal="0 -1 0" thread_length="6 mm" thread_diameter="0.175 mm" thread_young="1.5 GPa"
      thread_beams="6"/>
    <Track name="track" centre="0 0 5 mm" times="0.2 1.8 s" rotations="0 0 0  0 -161 0 deg"
      easing="smooth"/><Grasper at="23 mm"/>
    <Puncture threshold="0.3 N" exit_threshold="0.2 N" friction="0.2"/><Cutting threshold="0.1 N"/>
    <SuturePath spacing="1 mm"/><PathFriction coefficient="0.3" pressure="20 kPa"/>)" +
                  more,
              "dt='10 ms' gravity='0 0 0'");
  EXPECT_TRUE(run) << run.said();
  return run;
}

// A needle that goes in and out by its channel does not touch the skin besides: neither where its
// point presses nor at the mouths. So the contact changes nothing. Rows that carry no force are
// there, and with them another order of elimination: what a step leaves is another.
TEST(Mouth, AStitchIsTheSameWithContact) {
  // N: each of the two runs is solved to a hundredth of the forces, some 0.1 N.
  constexpr Real tiny = 2e-3;
  TextRun without = pricked(""), with = pricked(on_skin);
  ASSERT_TRUE(without && with);
  while (with.simulation().time() < 1.6 - 1e-9) {
    without.simulation().step();
    EXPECT_TRUE(with.simulation().step().solved);
    ASSERT_EQ(with.number("/contact", "touches"), 0) << with.simulation().time();
    EXPECT_LT((with.vector("/grasper", "force") - without.vector("/grasper", "force")).norm(), tiny)
        << with.simulation().time();
  }
  EXPECT_EQ(with.number("/puncture", "punctures"), 2);
}

// A straight needle goes in aslant and is then laid down and pressed on the skin: that carries it,
// from the first beam on that is wholly outside.
TEST(Mouth, WhatIsOutsideLiesOnTheSkin) {
  TextRun run(
      "<plugin name='contact'/>" +
          block("skin", "-12 -6 -8 12 6 0", "12 6 4", "<Attach box='-12 -6 -8 12 6 -8 mm'/>") +
          R"(<SutureThread name="suture" needle_length="16 mm" needle_angle="1 deg"
      needle_beams="16" needle_diameter="0.4 mm" tip="-0.5 0.2 0.6 mm" tip_direction="1 0 -1"
      plane_normal="0 1 0" thread_length="10 mm" thread_beams="10" thread_direction="-1 0 1"/>
    <Track name="go" centre="0.1 0.2 0 mm" times="0 0.8 1 2.4 s"
      positions="0 0 0  3.2 0 -3.2  3.2 0 -3.2  3.2 0 -1 mm"
      rotations="0 0 0 0 0 0 0 0 0 0 -44 0 deg"/>
    <Grasper body="suture" at="14 mm" track="go"/><Puncture threshold="0.1 N"/>
    <SuturePath spacing="0.5 mm"/><Contact first="suture" second="/skin/tissue"/>)",
      "dt='10 ms' gravity='0 0 0'");
  ASSERT_TRUE(run) << run.said();
  run.run(2.6);
  EXPECT_EQ(run.number("/puncture", "punctures"), 1);
  EXPECT_GT(run.number("/suture_path", "inserted_length"), 1e-3);
  EXPECT_GT(run.number("/contact", "touches"), 5);
  EXPECT_GT(run.vector("/contact", "force").z(), 0.05);
  // No beam outside is inside, but for that which leads through the mouth.
  std::vector<CurveSegment> beams;
  run.component<SegmentedCurve>("/suture").segments(Configuration::current, beams);
  const auto& skin = run.component<SolidBody>("/skin/tissue");
  const Real mouth = run.number("/suture_path", "inserted_length");
  int outside = 0;
  for (const CurveSegment& beam : beams) {
    if (beam.from < mouth + 3 * beam.radius) continue;
    ++outside;
    for (const Real u : {0., 0.5, 1.})
      EXPECT_FALSE(skin.locate(beam.point(u), Configuration::current)) << beam.from;
  }
  EXPECT_GT(outside, 20);
  EXPECT_GT(run.number("/contact", "distance"), -1e-6);
  EXPECT_TRUE(run.simulation().report().solved);
}

// Without a channel the point is no exception: it dents the skin and does not get in.
TEST(Mouth, ANeedleThatMayNotPierceStaysOutside) {
  TextRun run(
      "<plugin name='contact'/>" +
          block("skin", "-10 -5 -8 10 5 0", "6 4 4", "<Attach box='-10 -5 -8 10 5 -8 mm'/>") +
          R"(<SutureThread name="suture" needle_length="12 mm" needle_angle="10 deg"
      needle_diameter="0.5 mm" tip="0.3 0.2 1 mm" tip_direction="0.2 0 -1" plane_normal="0 1 0"
      thread_length="20 mm" thread_beams="20"/>
    <Track name="go" times="0 1 s" positions="0 0 0 0 0 -3 mm"/>
    <Grasper body="suture" at="6 mm" track="go"/>)" +
          on_skin.substr(on_skin.find("<Contact")),
      "dt='10 ms' gravity='0 0 0'");
  ASSERT_TRUE(run) << run.said();
  run.run(1);
  EXPECT_LT(run.vector("/suture", "tip_position").z(), -1.8e-3);
  EXPECT_GT(run.vector("/contact", "force").z(), 0.1);
  EXPECT_GT(run.number("/contact", "distance"), -1e-6);
}

/// A thread that is sewn through a slab, and a hand that draws it.
TextRun sewn_through(const std::string& thread, const std::string& hand, const std::string& way,
                     const std::string& dt) {
  TextRun run("<plugin name='contact'/>" +
                  block("skin", "-6 -6 -5 6 6 0", "6 6 4",
                        "<Attach name='left' box='-6 -6 -5 -6 6 0 mm'/>"
                        "<Attach name='right' box='6 -6 -5 6 6 0 mm'/>") +
                  R"(<SutureThread name="suture" needle_length="0" thread_density="1100"
      thread_diameter="0.2 mm" damping_stiffness="0.1 ms" damping_mass="10 1/s"
      thread_length="30 mm" plane_normal="0 1 0" )" +
                  thread + R"(/><SuturePath sewn="true" spacing="1 mm"/>
    <PathFriction coefficient="0.2" pressure="10 kPa"/>
    <Contact first="suture" second="/skin/tissue" friction="0.3"/><Track name="way" )" +
                  way + "/><Grasper name='hand' track='way' " + hand + "/>",
              "gravity='0 0 0' dt='" + dt + "'");
  EXPECT_TRUE(run) << run.said();
  return run;
}

// The end of a thread comes out of the tissue with its axis in the surface, nearer than a touch
// lets anything come. Its way was barred then, at every step to come, and with it the whole scene.
TEST(Mouth, AnEndThatIsDrawnOutIsFree) {
  struct Case {
    std::string thread, way, dt;
    Real duration;
  };
  for (const Case& c :
       {Case{"thread_young='2 GPa' bending_factor='0.05' thread_beams='60' tip='-6 0 12 mm' "
             "tip_direction='-0.5 0 1' sampling_angle='0.3 rad' shortest_beam='0.2 mm'",
             "times='0 2 s' positions='0 0 0 -3.96 -7.93 39 mm'", "20 ms", 2},
        Case{"thread_young='0.5 GPa' thread_beams='100' tip='4.8 0 16 mm' "
             "tip_direction='0.3 0 1'",
             "times='0 0.2 s' positions='0 0 0 25.2 -21 22.9 mm'", "2.5 ms", 0.3}}) {
    TextRun run = sewn_through(c.thread, "at='2 mm' rotation_stiffness='0'", c.way, c.dt);
    ASSERT_TRUE(run);
    while (run.simulation().time() < c.duration - 1e-9) {
      const StepReport& step = run.simulation().step();
      ASSERT_TRUE(step.solved && step.faults.empty()) << run.simulation().time();
    }
    EXPECT_EQ(run.number("/suture_path", "inserted_length"), 0);
    EXPECT_GT(run.number("/contact", "distance"), 0);
    // N: what is left is to brake the swing of 1 mg of thread, of some m/s^2.
    EXPECT_LT(run.vector("/hand", "force").norm(), 1e-4);
  }
}

// A channel is where the thread has been and ends where its end has been drawn to. Pushed back, the
// end goes into the tissue beside all that holds it: never in silence.
TEST(Mouth, AnEndThatIsPushedBackBesideItsChannelIsAFault) {
  TextRun run = sewn_through(
      "thread_young='2 GPa' bending_factor='0.3' thread_beams='60' "
      "tip='0 0 12 mm' tip_direction='0 0 1'",
      "at='27 mm'", "times='0 0.9 1 1.5 s' positions='0 0 0  0 0 16  0 0 16  0 0 13 mm'", "5 ms");
  ASSERT_TRUE(run);
  while (run.simulation().time() < 1 - 1e-9)
    ASSERT_TRUE(run.simulation().step().faults.empty()) << run.simulation().time();
  run.run(1.5);
  ASSERT_EQ(run.simulation().report().faults.size(), 1u);
  EXPECT_NE(run.simulation().report().faults[0].find("where no touch holds"), std::string::npos);
}

}  // namespace
}  // namespace sutura::testing
