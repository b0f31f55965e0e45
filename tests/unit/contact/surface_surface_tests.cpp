// Nodes of a block over a gutter: two planes that fall towards x = 0.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "contact_memory.h"
#include "scenes/text_run.h"
#include "surface_surface.h"

namespace sutura::contact {
namespace {

using testing::TextRun;

/// 10 x 30 mm, as OBJ.
std::string gutter_file(Real slope) {
  const std::string file = SUTURA_BINARY_DIR "/valley_" + std::to_string(slope) + ".obj";
  std::ofstream out(file);
  const Real high = 5 * std::tan(slope);
  for (const int y : {-15, 15}) {
    out << "v 0 " << y << " 0\nv -5 " << y << ' ' << high << "\nv -5 " << y << " -3\n";
    out << "v 5 " << y << " -3\nv 5 " << y << ' ' << high << '\n';
  }
  out << "f 1 2 3\nf 1 3 4\nf 1 4 5\nf 8 7 6\nf 9 8 6\nf 10 9 6\n";
  for (int k = 1; k <= 5; ++k) {
    const int next = k % 5 + 1;
    out << "f " << k << ' ' << k + 5 << ' ' << next + 5 << ' ' << next << '\n';
  }
  return file;
}

/// Touches of the nodes at x = 0 and of those at x = 1 mm, of a block of cells of 1 mm that is so
/// high over the bottom of the gutter.
std::pair<std::size_t, std::size_t> touches(Real slope, const std::string& height) {
  TextRun run("<plugin name='contact'/><node name='skin'><BlockMesh box='-1 -2.1 " + height +
              " 1 1.9 3 mm' cells='2 4 3'/><Tissue name='tissue' young='20 kPa' poisson='0.3'/>"
              "</node><Tool name='gutter' shape='mesh' unit='mm' file='" +
              gutter_file(slope) + "'/>");
  EXPECT_TRUE(run) << run.said();
  const auto& solid = run.component<MeshedSolid>("/skin/tissue");
  SurfaceSurface pair(std::make_shared<SolidBoundary>(solid),
                      std::make_shared<ToolBoundary>(run.component<RigidTool>("/gutter")));
  Body& body = run.component<Body>("/skin/tissue");
  body.load().setZero(body.dofs());
  body.begin_step(StepContext{});
  pair.begin_step();
  ContactMemory memory;
  std::vector<Touch> found;
  pair.find(memory, found);
  std::pair<std::size_t, std::size_t> at;
  for (const Touch& t : found) {
    const Real x = std::abs(t.at.x());  // of the foot: the node is 0.1 mm above
    if (t.node >= 0 && x < 0.1e-3) ++at.first;
    if (t.node >= 0 && x > 0.9e-3) ++at.second;
  }
  return at;
}

// One plane alone would lead a node into the other, and that one back.
TEST(Valley, HoldsANodeOnBothSides) {
  for (const Real slope : {0.3, 0.02}) {
    const auto [bottom, side] = touches(slope, "0.1");
    EXPECT_EQ(bottom, 2u * 5) << slope;
    EXPECT_LE(side, 2u * 5) << slope;
  }
}

// Nor is a plane held twice because it is two triangles.
TEST(Valley, IsNoneWhereItIsFlat) {
  const auto [middle, side] = touches(0, "0.1");
  EXPECT_EQ(middle, 5u);
  EXPECT_EQ(side, 2u * 5);
}

}  // namespace
}  // namespace sutura::contact
