// Two bars of tissue across each other, whose nodes are beside the crossing: only edges touch.
#include <gtest/gtest.h>

#include "contact_scenes.h"
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

/// The upper one is carried down by 1.4 mm, on to 0.2 mm below and 1.2 mm further.
std::string bars(const std::string& time) {
  return "<plugin name='contact'/>" +
         block("low", "-10 -2 -4 10 2 0", "3 1 2",
               "<Attach name='bed' box='-10 -2 -4 10 2 -4 mm'/>") +
         block("high", "-2 -10 0.2 2 10 4.2", "1 3 2",
               "<Track name='hand' times='0 " + time +
                   "' positions='0 0 0  0 0 -1.4 mm'/>"
                   "<Attach name='roof' box='-2 -10 4.2 2 10 4.2 mm' motion='hand'/>") +
         "<Contact first='/low/tissue' second='/high/tissue' friction='0.3'/>";
}

struct Pressed {
  Real force = 0, bed = 0, distance = 0;
};
Pressed press(const std::string& time, const std::string& dt) {
  TextRun run(bars(time), "gravity='0 0 0' dt='" + dt + "'");
  EXPECT_TRUE(run) << run.said();
  while (run.simulation().time() < 1) {
    const StepReport& report = run.simulation().step();
    EXPECT_TRUE(report.solved) << time << ' ' << report.time;
    EXPECT_TRUE(report.faults.empty()) << report.faults.front();
  }
  EXPECT_EQ(run.number("/contact", "touches"), 4);
  return {run.vector("/high/roof", "reaction").z(), run.vector("/low/bed", "reaction").z(),
          run.number("/contact", "distance")};
}

TEST(Edges, OfCrossedBarsHoldThemApart) {
  const Pressed slow = press("0.5 s", "10 ms");
  EXPECT_LT(slow.force, -0.1);
  EXPECT_NEAR(slow.bed, -slow.force, 1e-4);  // to a hundredth of the tolerance of a step
  EXPECT_GT(slow.distance, -1e-6);           // the tolerance of gaps
  // However fast: friction may leave a little of what it held on the way.
  for (const auto& [time, dt] :
       {std::pair{"10 ms", "10 ms"}, {"1 ms", "1 ms"}, {"20 ms", "20 ms"}}) {
    const Pressed fast = press(time, dt);
    EXPECT_NEAR(fast.force, slow.force, -0.03 * slow.force) << time;
    EXPECT_GT(fast.distance, -1e-6) << time;
  }
}

// One that is thrown at the other at 5 m/s does not go through, whatever the step: up to 250 mm of
// way in one. Half an edge of overlap is where ways end.
TEST(Edges, AreNotGoneThrough) {
  for (const char* dt : {"1 ms", "5 ms", "20 ms", "50 ms"}) {
    TextRun run(
        "<plugin name='contact'/>" +
            block("low", "-10 -2 -4 10 2 0", "3 1 2",
                  "<Attach name='bed' box='-10 -2 -4 10 2 -4 mm'/>") +
            "<node name='high'><BlockMesh box='-2 -10 3 2 10 7 mm' cells='1 3 2'/><Tissue "
            "name='tissue' young='20 kPa' poisson='0.3' density='1000' damping_stiffness='10 ms' "
            "velocity='0 0 -5'/></node><Contact first='/low/tissue' second='/high/tissue'/>",
        std::string("gravity='0 0 0' dt='") + dt + "'");
    ASSERT_TRUE(run) << run.said();
    const auto& high = run.component<Body>("/high/tissue");
    Real lowest = 1;
    while (run.simulation().time() < 0.1 - 1e-9) {
      ASSERT_TRUE(run.simulation().step().finite);
      lowest = std::min(lowest, high.centre_of_mass().z());
    }
    EXPECT_GT(lowest, -3e-3) << dt;  // its middle is 2 mm from its edges, the bed 4 mm below
    EXPECT_GT(high.momentum().z(), -0.2 * 5 * high.mass()) << dt << ": it has been stopped";
  }
}

TEST(Edges, AreAsFarApartAsTheirSurfaces) {
  TextRun run(bars("1 s"));
  ASSERT_TRUE(run) << run.said();
  EXPECT_NEAR(run.number("/contact", "distance"), 0.2e-3, 1e-9);
}

}  // namespace
}  // namespace sutura::testing
