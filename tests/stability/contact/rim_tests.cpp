// Edges and corners of tools in tissue: what is thrown at them never comes back with more energy.
#include <gtest/gtest.h>

#include <string>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

struct Impact {
  std::string name, cells, tissue, velocity, tool, dt, friction;
};

class Rim : public ::testing::TestWithParam<Impact> {};

// A free block of 12 x 10 x 6 mm hits an edge or a corner of a tool that stands still: nothing does
// work on it. With the nearest side of the tool as what faces a triangle, and with all of an
// overlap taken back in the step in which a triangle is touched first, its energy grew: by 27, 8,
// 26 and 602 % within a step.
TEST_P(Rim, GivesNoEnergyToWhatHitsIt) {
  const Impact& p = GetParam();
  TextRun run("<plugin name='contact'/><node name='b'><BlockMesh box='-6 -5 9 6 5 15 mm' cells='" +
                  p.cells + "'/><Tissue name='tissue' " + p.tissue + " velocity='" + p.velocity +
                  "'/></node><Tool name='tool' " + p.tool +
                  "/><Contact first='/b/tissue' tool='tool' friction='" + p.friction + "'/>",
              "gravity='0 0 0' dt='" + p.dt + "'");
  ASSERT_TRUE(run) << run.said();
  const Real start = run.number("/b/tissue", "energy");
  Real before = start;
  int missed = 0;
  while (run.simulation().time() < 0.2 - 1e-9) {
    const StepReport& report = run.simulation().step();
    missed += !report.solved || !report.faults.empty();
    const Real now = run.number("/b/tissue", "energy");
    // What may be missing in the balance of a step, a hundredth of its forces, does work.
    EXPECT_LT(now, 1.01 * before) << report.time;
    before = now;
  }
  EXPECT_LT(before, 0.9 * start);  // it has hit
  // As the block comes off the edge, two of its 100 steps are not solved, and say so, since a rim
  // is held beside single nodes (docs/decisions/contact.md).
  EXPECT_LE(missed, p.name == "edge" ? 2 : 0);
}

INSTANTIATE_TEST_SUITE_P(
    Thrown, Rim,
    ::testing::Values(
        Impact{"corner", "3 5 3", "young='20 kPa' poisson='0.45' damping_stiffness='5 ms'",
               "0.0344 -0.0267 -0.1026",
               "shape='box' size='11.507 7.670 2.006 mm' centre='1.795 -2.949 0 mm' axis='-0.578 "
               "-0.711 -0.674'",
               "2 ms", "0"},
        Impact{"stiff", "3 3 3", "young='200 kPa' poisson='0.45' damping_stiffness='5 ms'",
               "-0.0324 0.0008 -0.1521",
               "shape='box' size='10.755 3.157 5.496 mm' centre='3.105 3.134 0 mm' axis='0.256 "
               "-0.634 -0.409'",
               "1 ms", "0.2"},
        Impact{"rim", "3 4 2", "young='60 kPa' poisson='0.3' damping_stiffness='5 ms'",
               "0.1229 0.0033 -0.3971",
               "shape='cylinder' radius='4.308 mm' length='11.397 mm' centre='3.018 1.487 0 mm' "
               "axis='0.835 -0.502 0.630'",
               "5 ms", "0.2"},
        Impact{"edge", "3 4 4", "young='60 kPa' poisson='0.3'", "-0.0254 0.0365 -0.1744",
               "shape='box' size='7.992 4.314 2.546 mm' centre='-1.807 3.101 0 mm' axis='0.057 "
               "-0.109 0.887'",
               "2 ms", "0.2"}),
    [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace sutura::testing
