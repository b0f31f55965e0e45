// A needle goes through where its threshold is reached, and not where the step ends.
#include <string>

#include "text_run.h"

namespace sutura::testing {
namespace {

/// A half circle is turned into and out of a stiff block by 24 mm/s, and then rests.
TextRun bite(const char* dt) {
  return TextRun(
      "<node name='skin'><BlockMesh box='-15 -8 -10  15 8 0 mm' cells='20 8 6'/>"
      "<Tissue name='tissue' young='900 kPa' poisson='0.4' damping_stiffness='5 ms'/>"
      "<Attach box='-15 -8 -10  15 8 -10 mm'/></node>"
      "<SutureThread name='suture' needle_length='22 mm' needle_angle='150 deg' "
      "needle_diameter='0.6 mm' needle_centre='0 0 2.8 mm' tip_angle='-75 deg' "
      "plane_normal='0 -1 0' thread_length='30 mm' thread_beams='20' "
      "thread_direction='-1 0 0.3' thread_bend_radius='6 mm' damping_stiffness='0.2 ms' "
      "damping_mass='3 1/s'/>"
      "<Track name='turn' about='suture' times='0 0.2 1.2 s' turns='0 0 162 deg'/>"
      "<Grasper name='hand' track='turn' at='20 mm'/><Puncture name='puncture' friction='0.2' "
      "threshold='0.8 N'/><Cutting threshold='0.05 N'/><SuturePath spacing='1 mm'/>"
      "<PathFriction coefficient='0.3' pressure='5 kPa'/>",
      std::string("gravity='0 0 0' dt='") + dt + "'");
}

// Steps are divided in which the tip goes through, and no others, until it goes by no more than
// half of its radius, 0.15 mm, in a part: at 24 mm/s and 20 ms into two or four.
TEST(TimedPuncture, DividesItsStepAndNoOther) {
  TextRun run = bite("20 ms");
  ASSERT_TRUE(run) << run.said();
  Real punctures = 0;
  Index divided = 0;
  while (run.simulation().time() < 1.3) {
    const StepReport& report = run.simulation().step();
    EXPECT_FALSE(report.missed()) << report.time;
    const Real now = run.number("/puncture", "punctures");
    if (now > punctures)
      EXPECT_TRUE(report.parts == 2 || report.parts == 4) << report.time;
    else
      EXPECT_EQ(report.parts, 1) << report.time;
    divided += report.parts > 1;
    punctures = now;
  }
  EXPECT_EQ(divided, 2);
}

// The force at rest goes by where the mouths are, to the way of the tip in a step times the
// stiffness of the tissue. At the end of their step they were up to 1.2 mm further on, and the hand
// felt 2.3 times what it feels with steps of 2 ms, and half of it with steps of 20 ms. What is
// left, a third at 20 ms, is how far tissue is dragged along in the step.
TEST(TimedPuncture, ALongStepLeavesTheForceOfAShortOne) {
  TextRun brief = bite("2 ms");
  ASSERT_TRUE(brief) << brief.said();
  brief.run(1.4);
  const Real right = brief.vector("/hand", "force").norm();
  for (const char* dt : {"20 ms", "50 ms"}) {
    TextRun lengthy = bite(dt);
    lengthy.run(1.4);
    EXPECT_NEAR(lengthy.vector("/hand", "force").norm(), right, 0.35 * right) << dt;
  }
}

}  // namespace
}  // namespace sutura::testing
