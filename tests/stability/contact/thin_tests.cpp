// Tissue that is thinner than its triangles are long: what has come to one of its sides is told
// from what is beyond the other one.
#include <gtest/gtest.h>

#include <algorithm>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

const std::string contact = "<plugin name='contact'/>";

/// All nodes of both are carried, so nothing can give way: the step that goes through says it.
void expect_said(const std::string& scene) {
  for (const char* dt : {"1 ms", "10 ms", "50 ms"}) {
    TextRun run(contact + scene, std::string("gravity='0 0 0' substeps='1' dt='") + dt + "'");
    ASSERT_TRUE(run) << run.said();
    bool said = false;
    while (run.simulation().time() < 0.1 - 1e-9) {
      const StepReport& report = run.simulation().step();
      said = said || !report.solved || !report.faults.empty();
    }
    EXPECT_TRUE(said) << dt;
  }
}

// A sheet of 0.2 mm with triangles of 4 mm, and another one that comes down on it edge first.
TEST(ThinTissue, IsNotGoneThroughInSilence) {
  expect_said(
      "<node name='low'><BlockMesh box='-10 -10 -0.2 10 10 0 mm' cells='5 5 1'/><Tissue "
      "name='tissue'/><Attach box='-10 -10 -0.2 10 10 0 mm'/></node><Track name='hand' times='0 "
      "0.05 s' positions='0 0 0  0 0 -7 mm'/><node name='high'><BlockMesh box='-4.1 -0.1 1 4 0.1 "
      "13 mm' cells='2 1 3'/><Tissue name='tissue'/><Attach box='-5 -1 0 5 1 14 mm' "
      "motion='/hand'/></node><Contact first='/low/tissue' second='/high/tissue'/>");
}

// One mesh of a sheet and a block above it: the sheet is not taken for touching itself from side to
// side (such a scene is refused), and the block does not go through it.
TEST(ThinTissue, TouchesItselfOnlyWhereItIsFolded) {
  expect_said(
      "<Track name='hand' times='0 0.05 s' positions='0 0 0  0 0 -12 mm'/><node name='low'>"
      "<BlockMesh box='-10 -10 -0.2 10 10 12.2 mm' cells='5 5 62' holes='-10 -10 0  10 -2 12.2  "
      "-10 2 0  10 10 12.2  -10 -3 0  10 3 6 mm'/><Tissue name='tissue'/><Attach name='a' "
      "box='-10 -10 -0.2 10 10 0 mm'/><Attach name='b' box='-10 -10 5 10 10 12.2 mm' "
      "motion='/hand'/></node><Contact first='/low/tissue'/>");
}

// Two bars of 2 mm with elements of up to 23 mm. A node that is beyond the far side of a bar was
// taken for having come in there, and in one step the bar was thrown out with a hundred times the
// energy. Nothing that is stored drives these bars, so their energy never grows.
TEST(ThinTissue, IsNotEnteredFromItsFarSide) {
  TextRun run(
      contact +
          "<node name='low'><BlockMesh corners='-11.958 0 -1.36  11.958 0 -1.36  -11.958 1.36 0  "
          "11.958 1.36 0  -11.958 -1.36 0  11.958 -1.36 0  -11.958 0 1.36  11.958 0 1.36 mm' "
          "cells='4 1 1'/><Tissue name='tissue' young='21 kPa' poisson='0.3' "
          "damping_stiffness='1 ms'/><Attach name='a' box='-12 -9 -9 -10.8 9 9 mm'/>"
          "<Attach name='b' box='10.8 -9 -9 12 9 9 mm'/></node>"
          "<node name='high'><BlockMesh corners='-10.445 0.369 2.312  11.829 1.618 2.312  -10.548 "
          "2.208 4.153  11.726 3.457 4.153  -10.342 -1.469 4.153  11.932 -0.22 4.153  -10.445 "
          "0.369 5.994  11.829 1.618 5.994 mm' cells='1 1 2'/><Tissue name='tissue' young='32 "
          "kPa' poisson='0.3' damping_stiffness='1 ms' velocity='-0.0666 0.0323 -0.285'/></node>"
          "<Contact first='/low/tissue' second='/high/tissue' friction='0.588'/>",
      "gravity='0 0 0' dt='2 ms'");
  ASSERT_TRUE(run) << run.said();
  const auto energy = [&] {
    return run.number("/low/tissue", "energy") + run.number("/high/tissue", "energy");
  };
  Real before = energy();
  while (run.simulation().time() < 0.04 - 1e-9) {
    const StepReport& report = run.simulation().step();
    EXPECT_TRUE(report.solved) << report.time;
    EXPECT_TRUE(report.faults.empty()) << report.faults.front();
    // What may be missing in the balance of a step, a hundredth of its forces, does work.
    EXPECT_LT(energy(), 1.01 * before) << report.time;
    before = energy();
  }
}

}  // namespace
}  // namespace sutura::testing
