// A block of tissue lies across the edge of a box: it stays while its middle is over the box.
#include <gtest/gtest.h>

#include "contact_scenes.h"
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

/// 20 mm long, in cells of 2 mm; so much of it (mm) is beyond the edge, which no row of nodes is
/// on.
std::string overhanging(Real beyond) {
  return "<plugin name='contact'/><node name='block'><BlockMesh box='0 0 0.02 20 8 6 mm' "
         "cells='10 3 3'/><Tissue name='tissue' young='300 kPa' poisson='0.3' density='1000' "
         "damping_stiffness='5 ms'/></node>"
         "<TissueProbe name='all' tissue='/block/tissue' box='-1 -1 -1 1 1 1'/>"
         "<Tool name='shelf' shape='box' size='40 30 10 mm' centre='" +
         std::to_string(-beyond) +
         " 4 -5 mm'/><Contact first='/block/tissue' tool='shelf' friction='0.6'/>";
}

struct Outcome {
  Real height = 0;  ///< of the middle (m)
  int missed = 0, missed_last = 0;
};
Outcome let_lie(Real beyond, const std::string& dt) {
  TextRun run(overhanging(beyond), "dt='" + dt + "'");
  EXPECT_TRUE(run) << run.said();
  Outcome out;
  while (run.simulation().time() < 0.5 - 1e-9) {
    const StepReport& report = run.simulation().step();
    out.missed += !report.solved;
    if (run.simulation().time() > 0.45) out.missed_last += !report.solved;
  }
  out.height = run.vector("/all", "position").z();
  return out;
}

constexpr Real at_rest = 3e-3;  // m: half of its height

TEST(Overhang, StaysWhereRowsOfNodesHoldIt) {
  for (const char* dt : {"1 ms", "5 ms", "20 ms"}) {
    const Outcome out = let_lie(7, dt);
    EXPECT_NEAR(out.height, at_rest, 20e-6) << dt;  // its own weight presses it by 13 um
    EXPECT_EQ(out.missed, 0) << dt;
  }
}

// The last row of nodes over the box is below the middle of the block, and the edge 1.8 mm further:
// the block turns about these nodes until the edge has cut into the triangles beside them by a
// twentieth of theirs. Before edges were seen there it went on to a fourth, with its ways barred,
// and no step was solved from then on.
TEST(Overhang, IsCaughtByTheEdgeBesideNodes) {
  const Outcome out = let_lie(8.2, "5 ms");
  EXPECT_NEAR(out.height, at_rest, 0.1e-3);
  EXPECT_EQ(out.missed_last, 0);
  EXPECT_LT(out.missed, 10);
}

TEST(Overhang, FallsWhereItsMiddleIsBeyondTheEdge) {
  for (const char* dt : {"5 ms", "20 ms"}) {
    const Outcome out = let_lie(11, dt);
    EXPECT_LT(out.height, -0.1) << dt;
    EXPECT_EQ(out.missed_last, 0) << dt;
    EXPECT_LT(out.missed, 10) << dt;
  }
}

}  // namespace
}  // namespace sutura::testing
