// A needle that goes past a body, past its edge, or through it within a step.
#include <gtest/gtest.h>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

/// A straight needle of 0.5 mm above a block, its tip at x mm; it goes along `way` in `seconds`.
std::string needle_at(const std::string& x, const std::string& way, const std::string& seconds,
                      const std::string& block = "-8 -8 0  8 8 6 mm") {
  return "<BlockMesh box='" + block +
         "' cells='8 8 4'/><Tissue young='50 kPa' damping_stiffness='5 ms'/>"
         "<Attach box='-8 -8 0  8 8 0 mm'/>"
         "<SutureThread name='suture' needle_length='60 mm' needle_angle='0' needle_diameter='0.5 "
         "mm' tip='" +
         x +
         " 0.3 10 mm' tip_direction='0 0 -1' plane_normal='0 1 0' thread_length='40 mm' "
         "thread_beams='20'/><Track times='0.1 " +
         seconds + " s' positions='0 0 0 " + way +
         " mm'/><Grasper at='50 mm'/><SuturePath spacing='1 mm'/><Puncture threshold='0.2 N'/>"
         "<Cutting threshold='0.05 N'/><PathFriction pressure='20 kPa'/>";
}

struct Way {
  const char* x;   // mm, the block ends at 8
  const char* dt;  // ms
};

class Past : public ::testing::TestWithParam<Way> {};

TEST_P(Past, ANeedleBesideABlockFeelsNothing) {
  const auto [x, dt] = GetParam();
  TextRun run(needle_at(x, "0 0 -20", "0.3"), std::string("dt='") + dt + " ms' gravity='0 0 0'");
  ASSERT_TRUE(run) << run.said();
  while (run.simulation().time() < 0.4) {
    run.simulation().step();
    ASSERT_EQ(run.number("/puncture", "force"), 0) << run.simulation().time();
  }
  EXPECT_EQ(run.number("/puncture", "punctures"), 0);
  EXPECT_EQ(run.number("/puncture", "overruns"), 0);
  EXPECT_LT(run.number("/tissue", "max_displacement"), 1e-15);
}

// Half a millimetre and more beside the edge; 0.5 to 5 mm a step.
INSTANTIATE_TEST_SUITE_P(Block, Past,
                         ::testing::Values(Way{"8.5", "5"}, Way{"8.5", "20"}, Way{"9", "5"},
                                           Way{"9", "20"}, Way{"10", "20"}, Way{"9", "50"},
                                           Way{"12", "50"}));

TEST(PastABody, WhatSlidesOverAnEdgeIsFree) {
  // Pressed by 0.3 mm and drawn along: to 3 mm beyond the edge.
  TextRun run(needle_at("6", "0 0 -4.3 5 0 -4.3", "0.3 0.8"), "dt='5 ms' gravity='0 0 0'");
  ASSERT_TRUE(run) << run.said();
  run.run(0.35);
  EXPECT_GT(run.number("/puncture", "force"), 0.01);
  run.run(1);
  EXPECT_EQ(run.number("/puncture", "force"), 0);
  EXPECT_EQ(run.number("/puncture", "punctures"), 0);
  EXPECT_LT(run.number("/tissue", "max_displacement"), 1e-9);
  EXPECT_LT(run.vector("/grasper", "force").norm(), 1e-6);
}

TEST(PastABody, ASheetThatIsGoneThroughInOneStepHasTwoHoles) {
  // 12 mm in the first step, through 2 mm. Before, nothing held it on its way out.
  TextRun run(needle_at("0", "0 0 -24", "0.2", "-8 -8 0  8 8 2 mm"), "dt='50 ms' gravity='0 0 0'");
  ASSERT_TRUE(run) << run.said();
  while (run.simulation().time() < 0.4) EXPECT_TRUE(run.simulation().step().faults.empty());
  EXPECT_EQ(run.number("/puncture", "punctures"), 2);
  EXPECT_EQ(run.number("/puncture", "overruns"), 0);
  EXPECT_NEAR(run.number("/suture_path", "inserted_length"), 2e-3, 0.2e-3);
}

}  // namespace
}  // namespace sutura::testing
