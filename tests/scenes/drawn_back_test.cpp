// A needle bites into the face of a lip and comes out of it again, then it is turned back through
// its own channel. Its shaft has pressed the lip in, which springs back past the tip as that leaves
// the mouth. The tip has gone through two surfaces by then, and goes through no other: it moves
// backwards, and what springs back presses with less than it took to get in.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "text_run.h"

namespace sutura::testing {
namespace {

// Pushed out at once, the tip stitched its way out with 6 and 7 punctures at these steps, and with
// more force than the way in took; at 5 ms it did not.
TEST(DrawnBack, GoesThroughNothingOnItsWayOut) {
  for (const char* dt : {"1.25 ms", "1 ms"}) {
    TextRun run(
        "<BlockMesh box='-12 -12 -6 0 12 0 mm' cells='8 16 4'/><Tissue young='40 kPa' "
        "poisson='0.4' damping_stiffness='5 ms'/><Attach box='-12 -12 -6 0 12 -6 mm'/>"
        "<SutureThread name='suture' needle_length='17 mm' needle_angle='135 deg' "
        "needle_diameter='0.5 mm' tip='1 -7 -2 mm' tip_direction='-0.72 0.69 0' "
        "plane_normal='0 0 -1' thread_length='60 mm' thread_beams='60' thread_diameter='0.15 mm' "
        "bending_factor='0.2' damping_mass='5 1/s' damping_stiffness='0.1 ms'/>"
        "<Track about='suture' times='0 0.6 0.7 1.3 s' turns='0 130 130 0 deg' easing='smooth'/>"
        "<Grasper at='15 mm'/><SuturePath spacing='1 mm'/><Puncture threshold='0.2 N'/>"
        "<Cutting threshold='0.05 N'/><PathFriction coefficient='0.2' pressure='20 kPa'/>",
        "gravity='0 0 0' dt='" + std::string(dt) + "'");
    ASSERT_TRUE(run) << run.said();
    Real in = 0, out = 0;
    while (run.simulation().time() < 1.4) {
      EXPECT_TRUE(run.simulation().step().solved) << dt << ' ' << run.simulation().time();
      Real& largest = run.simulation().time() < 0.65 ? in : out;
      largest = std::max(largest, run.vector("/grasper", "force").norm());
    }
    EXPECT_EQ(run.number("/puncture", "punctures"), 2) << dt;
    EXPECT_EQ(run.number("/suture_path", "inserted_length"), 0) << dt;
    EXPECT_LT(out, in) << dt;
  }
}

}  // namespace
}  // namespace sutura::testing
