// Needles through layers with thresholds of their own: the mesh has no surface between them, and
// the tip is held where one begins until the force is that of the layer.
#include <algorithm>
#include <ostream>
#include <string>

#include "text_run.h"
#include "tissue_meshes.h"

namespace sutura::testing {
namespace {

constexpr Real threshold = 0.4;  // N, of the layer

struct Case {
  const char* dt;
  const char* name;
  Real low, high;      ///< mm, of the layer; the block is from -12 to 0
  const char* needle;  ///< where its tip begins and points, and what it goes through first
  const char* way;     ///< of the hand
  int punctures;
  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.name << ", " << c.dt; }
};

class Layers : public ::testing::TestWithParam<Case> {};

TEST_P(Layers, HoldTheTipUpToTheirThreshold) {
  const Case& c = GetParam();
  test::MeshData mesh = test::kuhn_block({9, 9, 15}, Vec3(18e-3, 18e-3, 12e-3));
  for (Vec3& p : mesh.points) p -= Vec3(9e-3, 9e-3, 12e-3);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    Real middle = 0;
    for (const Index i : mesh.tets[e]) middle += 250 * mesh.points[i].z();
    mesh.region[e] = middle > c.low && middle < c.high ? 2 : 1;
  }
  const std::string file = ::testing::TempDir() + "layers_" + c.name + "_" + c.dt[0] + ".msh";
  test::write_msh(mesh, file);
  TextRun run(
      "<TetMesh file='" + file +
          "'/><Tissue young='60 kPa' poisson='0.35' density='1000' damping_stiffness='5 ms'/>"
          "<Attach name='one' box='-9 -9 -12 -8 9 0 mm'/>"
          "<Attach name='other' box='8 -9 -12 9 9 0 mm'/>"
          "<SutureThread name='suture' needle_length='30 mm' needle_angle='0' "
          "needle_diameter='0.6 mm' thread_length='5 mm' thread_beams='5' " +
          c.needle + "/><Track times='0 1.5 s' positions='0 0 0  " + c.way +
          " mm'/><Grasper at='25 mm'/><SuturePath spacing='0.5 mm'/><Puncture "
          "threshold='0.1 N' regions='2' region_thresholds='0.4 N' exit_threshold='0.1 N'/>"
          "<Cutting threshold='0.02 N'/>",
      std::string("dt='") + c.dt + "' gravity='0 0 0'");
  ASSERT_TRUE(run) << run.said();
  Real highest = 0;
  bool holds = false;
  while (run.simulation().time() < 1.5 - 1e-9) {
    const StepReport& report = run.simulation().step();
    EXPECT_FALSE(report.missed()) << report.step;
    const std::string state = std::get<std::string>(run.output("/puncture", "state"));
    const Real punctures = run.number("/puncture", "punctures");
    // From when it first presses on the layer until it is through, it is never let go.
    if (holds && punctures < 2) {
      EXPECT_EQ(state, "layer") << report.step;
    }
    holds = state == "layer";
    if (holds) highest = std::max(highest, run.number("/puncture", "force"));
  }
  EXPECT_EQ(run.number("/puncture", "punctures"), c.punctures);
  // The force grows by less than a tenth of the threshold in a step.
  EXPECT_GT(highest, 0.9 * threshold);
  EXPECT_LE(highest, threshold);
}

const char* const down = "tip='0.3 0.2 1 mm' tip_direction='0 0 -1' plane_normal='0 1 0'";
const char* const up = "tip='0.3 0.2 -13 mm' tip_direction='0 0 1' plane_normal='0 1 0'";
const char* const oblique =
    "tip='-1.092 0.2 1 mm' tip_direction='0.3420201433 0 -0.9396926208' plane_normal='0 1 0'";

// A fascia or dermis of 0.8 mm was never felt, as the tip looked for layers 1 mm ahead and nowhere
// between; one that was met at 15 to 35 degrees was lost at half of its threshold, as a tip that
// presses compresses what is behind it, and so is no more at the end of its channel.
INSTANTIATE_TEST_SUITE_P(
    StepsAndWays, Layers,
    ::testing::Values(Case{"10 ms", "fascia", -3.2, -2.4, down, "0 0 -7.5", 2},
                      Case{"2.5 ms", "fascia", -3.2, -2.4, down, "0 0 -7.5", 2},
                      Case{"10 ms", "dermis_from_below", -0.8, 1, up, "0 0 15", 3},
                      Case{"10 ms", "deep", -12, -3.2, oblique, "2.184 0 -6", 2},
                      Case{"2.5 ms", "deep", -12, -3.2, oblique, "2.184 0 -6", 2}));

TEST(Laws, ASecondOneOnAPathIsRefused) {
  const std::string tissue =
      "<BlockMesh box='-4 -4 -4 4 4 0 mm' cells='2 2 2'/>"
      "<Tissue young='40 kPa' poisson='0.4' density='1000'/>"
      "<SutureThread tip='0 0 1 mm' tip_direction='0 0 -1' "
      "plane_normal='0 1 0'/><SuturePath/>";
  for (const std::string law : {"Puncture", "Cutting", "PathFriction"}) {
    TextRun run(tissue + "<" + law + " name='one'/><" + law + " name='other'/>");
    EXPECT_FALSE(run);
    EXPECT_NE(run.said().find("a second " + law + " on this path"), std::string::npos)
        << run.said();
  }
  TextRun run(tissue + "<Puncture regions='0 0' region_thresholds='0.2 0.1 N'/>");
  EXPECT_FALSE(run);
  EXPECT_NE(run.said().find("'0' is named twice"), std::string::npos) << run.said();
}

// What is missing of balance at rest is the rounding of the stiff layer's forces. Measured by the
// young of a Tissue that has none of its own, 3 kPa, it was a miss in nearly every step of 1 ms.
TEST(TissueOfLayers, RestsInOnePassHoweverStiffTheyAre) {
  for (const char* young : {"60 kPa", "600 kPa", "3 MPa"}) {
    TextRun run(
        "<TetMesh file='../meshes/pad.msh' unit='mm'/><Tissue damping_stiffness='10 ms'/>"
        "<Layer name='a' region='dermis' young='" +
            std::string(young) +
            "'/><Layer name='b' region='fat' young='60 kPa'/>"
            "<Attach box='-100 -100 -100  100 100 -4 mm'/>",
        "dt='1 ms' gravity='0 0 0'");
    ASSERT_TRUE(run) << run.said();
    for (int i = 0; i < 20; ++i) {
      const StepReport& step = run.simulation().step();
      EXPECT_TRUE(step.solved) << young;
      EXPECT_EQ(step.passes, 1) << young;
    }
  }
}

}  // namespace
}  // namespace sutura::testing
