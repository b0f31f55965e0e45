// A needle through sheets that are thinner than the tip looks ahead: what is on the far side is not
// what the tip presses on.
#include "text_run.h"

namespace sutura::testing {
namespace {

struct Sheet {
  const char *thick, *cells, *young, *threshold, *tilt, *tip;
};

// Before, the tip that had come out below was taken for pressing on the upper side, from below it:
// eight, four and three punctures.
TEST(ThinSheet, IsPuncturedOnceFromEachSide) {
  for (const Sheet& s : {Sheet{"0.7", "8", "300 kPa", "0.05 N", "-0.2135", "0.0553 0.5274"},
                         Sheet{"0.5", "12", "100 kPa", "0.2 N", "-0.1002", "0.0976 0.4061"},
                         Sheet{"0.7", "16", "50 kPa", "0.1 N", "-0.3763", "0.0419 -0.2135"}}) {
    const std::string cells = s.cells, tilt = s.tilt;
    TextRun run("<node name='sheet'><BlockMesh box='-8 -8 -" + std::string(s.thick) +
                    " 8 8 0 mm' cells='" + cells + " " + cells +
                    " 1'/><Tissue name='tissue' young='" + s.young +
                    "' poisson='0.4' damping_stiffness='5 ms'/><Attach name='a' box='-8 -8 -9 -7.5 "
                    "8 1 mm'/>"
                    "<Attach name='b' box='7.5 -8 -9 8 8 1 mm'/><Attach name='c' box='-7.4 -8 -9 "
                    "7.4 -7.5 1 "
                    "mm'/><Attach name='d' box='-7.4 7.5 -9 7.4 8 1 mm'/></node>"
                    "<SutureThread name='suture' needle_length='20 mm' needle_angle='0' tip='" +
                    s.tip + " 0.5 mm' tip_direction='" + tilt +
                    " 0 -1' plane_normal='0 1 0' thread_length='50 mm'/><Track times='0 0.2 s' "
                    "positions='0 0 0 " +
                    std::to_string(10 * std::stod(tilt)) +
                    " 0 -10 mm'/><Grasper at='15 mm'/><SuturePath name='path' spacing='0.5 mm'/>"
                    "<Puncture name='puncture' threshold='" +
                    s.threshold + "'/><PathFriction coefficient='0.3' pressure='20 kPa'/>",
                "dt='1 ms' gravity='0 0 0'");
    ASSERT_TRUE(run) << run.said();
    while (run.simulation().time() < 0.2 - 1e-9) {
      const StepReport& report = run.simulation().step();
      ASSERT_TRUE(report.solved && report.faults.empty()) << report.time;
    }
    EXPECT_EQ(run.number("/puncture", "punctures"), 2) << s.thick;
    EXPECT_EQ(run.number("/puncture", "overruns"), 0) << s.thick;
  }
}

}  // namespace
}  // namespace sutura::testing
