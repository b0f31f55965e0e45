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

}  // namespace
}  // namespace sutura::testing
