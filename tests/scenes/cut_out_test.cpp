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

}  // namespace
}  // namespace sutura::testing
