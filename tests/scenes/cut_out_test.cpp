// A thread that is pulled across its channel cuts sideways through the tissue: at a stated load per
// length, and out of it where the tissue ends.
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

constexpr Real strength = 100;  // N/m, as in the scenes

class CutOut : public ::testing::TestWithParam<const char*> {};

// All of the wall is at its limit: whatever the wire, the step and the place, the hand pulls with
// strength times thickness, and its work is strength times the area that is cut.
TEST_P(CutOut, TakesItsStrengthTimesTheLengthUntilItIsOut) {
  TextRun run = TextRun::file("validation/cut_out.xml", {{".dt", GetParam()}});
  ASSERT_TRUE(run);
  Simulation& simulation = run.simulation();
  constexpr Real thickness = 5e-3, way_to_the_side = 3e-3 - 0.1e-3;
  Real work = 0;
  bool was_out = false;
  while (simulation.time() < 2.4 - 1e-9) {
    const Real speed = simulation.time() > 1.2 - 1e-9 ? 4.5e-3 / 1.2 : 0;
    const StepReport& report = simulation.step();
    ASSERT_TRUE(report.solved) << report.step;
    ASSERT_TRUE(report.faults.empty()) << report.faults.front();
    const Real pull = run.vector("/grasper", "force").x();
    work += pull * speed * simulation.scene().dt;
    was_out = was_out || (report.time > 1.3 && run.number("/suture_path", "samples") == 0);
    // The load is there when the wire has given way by less than a millimetre, at 1.5 s; from 2 s
    // on the wire is at the side.
    if (report.time > 1.75 && report.time < 1.95) {
      const Real length = run.number("/suture_path", "inserted_length");
      EXPECT_NEAR(length, thickness, 0.01 * thickness);  // it leans
      // The gap of a sample is across the wire, which leans by a tenth of a radian.
      EXPECT_NEAR(pull, strength * length, 0.01 * strength * length) << report.time;
    }
  }
  EXPECT_TRUE(was_out);
  EXPECT_LT(run.vector("/grasper", "force").norm(), 0.01 * strength * thickness);
  const Real cut = run.number("/suture_path", "cut");
  // A sample is out as a whole, at the end of a step: an eighth of a millimetre at 50 ms, and the
  // part of its wall that is still left.
  EXPECT_NEAR(cut, thickness * way_to_the_side, 0.1 * thickness * way_to_the_side);
  EXPECT_NEAR(work, strength * cut, 0.1 * strength * cut);
}

INSTANTIATE_TEST_SUITE_P(Steps, CutOut, ::testing::Values("1 ms", "10 ms", "50 ms"));

// The same with the point of the wire inside and pushed on meanwhile, whatever the spacing of the
// samples: 3.8 mm are inside in the end.
TEST(CutOut, WithThePointInsideTakesItsStrengthTimesWhatIsInside) {
  for (const char* spacing : {"1 mm", "0.4 mm"}) {
    TextRun run = TextRun::file("validation/cut_out.xml",
                                {{"/way.positions", "0 0 0  0 0 -4.3  0 0 -4.3  4.5 0 -5 mm"},
                                 {"/suture_path.spacing", spacing}});
    ASSERT_TRUE(run);
    run.run(1.5);
    while (run.simulation().time() < 1.95) {
      ASSERT_TRUE(run.simulation().step().solved);
      const Real length = run.number("/suture_path", "inserted_length");
      EXPECT_NEAR(run.vector("/grasper", "force").x(), strength * length, 0.01 * strength * length)
          << spacing << " at " << run.simulation().time();
    }
  }
}

TEST(CutOut, BelowItsStrengthNothingIsCut) {
  TextRun run = TextRun::file("validation/cut_out.xml", {{"/suture_path.strength", "1e5 N/m"}});
  ASSERT_TRUE(run);
  run.run(1.9);
  EXPECT_EQ(run.number("/suture_path", "cut"), 0);
  EXPECT_GT(run.vector("/grasper", "force").x(), 2 * strength * 5e-3);
}

/// A thread sewn straight through a slab of 4 mm, drawn sideways from below while it is held above:
/// it leans by 60 degrees and bows as it cuts.
struct Leaning {
  Real length = 0, cut = 0, pull = 0;
};
Leaning drawn_aside(const std::string& dt) {
  TextRun run(
      "<BlockMesh box='-5 -5 -4  5 5 0 mm' cells='7 7 4'/><Tissue young='60 kPa' poisson='0.4' "
      "damping_stiffness='2 ms'/><Attach name='a' box='-5 -5 -4  -5 5 0 mm'/><Attach name='b' "
      "box='5 -5 -4  5 5 0 mm'/><SutureThread needle_length='0' tip='0.11 0.07 -14 mm' "
      "tip_direction='0 0 -1' plane_normal='0 1 0' thread_length='40 mm' thread_beams='40' "
      "thread_diameter='0.2 mm' damping_mass='20 1/s'/><Track name='pull' times='0.2 0.9 s' "
      "positions='0 0 0  30 0 8 mm'/><Grasper name='hand' track='pull' at='2 mm'/><Track "
      "name='still' times='0 s' positions='0 0 0 mm'/><Grasper name='other' track='still' at='20 "
      "mm'/><SuturePath name='path' spacing='0.5 mm' sewn='true' strength='20 N/m'/><PathFriction "
      "coefficient='0.3' pressure='10 kPa'/>",
      "gravity='0 0 0' dt='" + dt + "'");
  EXPECT_TRUE(run) << run.said();
  while (run && run.simulation().time() < 0.4 - 1e-9) {
    const StepReport& report = run.simulation().step();
    EXPECT_TRUE(report.solved && report.faults.empty()) << dt << ", step " << report.step;
    // It has not come to the side yet, so no less of it is in the slab than the slab is thick.
    EXPECT_GT(run.number("/path", "inserted_length"), 3.99e-3) << dt << " at " << report.time;
  }
  return {run.number("/path", "inserted_length"), run.number("/path", "cut"),
          run.vector("/hand", "force").x()};
}

// A mouth goes along the surface to where the thread goes through it. It was moved across the
// thread, as the samples inside are: more than half a diameter away from the surface it got lost in
// the slab, and the bite with it.
TEST(CutOut, AThreadThatLeansKeepsItsMouthsOnTheSurface) {
  const Leaning fine = drawn_aside("2 ms");
  // 4 mm of slab, of which a thread that leans takes more. At 0.25 to 2 ms it was 4.70 mm before
  // the mouths were sought along the thread.
  EXPECT_NEAR(fine.length, 4.74e-3, 0.05e-3);
  for (const char* dt : {"5 ms", "10 ms", "20 ms"}) {
    // Of first order in the step: 0.3, 0.8 and 1.6 % of the length, 2.4 % of the area cut.
    const Leaning coarse = drawn_aside(dt);
    EXPECT_NEAR(coarse.length, fine.length, 0.02 * fine.length) << dt;
    EXPECT_NEAR(coarse.cut, fine.cut, 0.03 * fine.cut) << dt;
    EXPECT_NEAR(coarse.pull, fine.pull, 0.03 * fine.pull) << dt;
  }
}

}  // namespace
}  // namespace sutura::testing
