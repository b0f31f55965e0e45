// Tissue that is thinner than its triangles are long: what has come to one of its sides is told
// from what is beyond the other one. And tools that are small beside the triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

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

/// The deepest point of the rims of a cylinder in a tissue (m).
Real rim_inside(const SolidBody& tissue, const Vec3& centre, const Vec3& axis, Real radius,
                Real length) {
  Real deepest = 0;
  const Vec3 across = axis.unitOrthogonal(), other = axis.cross(across);
  for (int i = 0; i < 72; ++i)
    for (const Real end : {-0.5, 0.5}) {
      const Real angle = i * std::numbers::pi / 36;
      const Vec3 p = centre + end * length * axis +
                     radius * (std::cos(angle) * across + std::sin(angle) * other);
      if (!tissue.locate(p, Configuration::current)) continue;
      const auto near = tissue.closest_surface(p, 1, Configuration::current);
      if (near) deepest = std::max(deepest, std::abs(near->distance));
    }
  return deepest;
}

// A cylinder of 0.9 mm that is carried 4 mm down in one step, between the nodes of a block: to find
// it nearly parallel to a triangle took hundreds of projections, and it was inside without a word.
TEST(SmallTool, DoesNotDiveIntoTissueInSilence) {
  for (const char* tilt : {"0.81 -0.242 0.005", "1 0 0", "0 1 0.02", "0.7 0.7 0.1"}) {
    TextRun run(contact +
                    "<node name='skin'><BlockMesh box='-12 -8 -6 12 8 0 mm' cells='5 6 3'/><Tissue "
                    "name='tissue' young='29 kPa' poisson='0.3' damping_stiffness='10 ms'/><Attach "
                    "box='-12 -8 -6 12 8 -6 mm'/></node><Track name='hand' times='0 1 ms' "
                    "positions='0 0 0  -1.3 -2.1 -4 mm'/><Tool name='tool' shape='cylinder' "
                    "radius='0.436 mm' length='3.176 mm' axis='" +
                    tilt +
                    "' centre='-0.096 2.006 1.952 mm' motion='/hand'/><Contact "
                    "first='/skin/tissue' tool='tool'/>",
                "gravity='0 0 0' dt='1 ms'");
    ASSERT_TRUE(run) << run.said();
    const StepReport& report = run.simulation().step();
    const auto& tissue = run.component<SolidBody>("/skin/tissue");
    EXPECT_TRUE(!report.solved || !report.faults.empty() ||
                !tissue.locate(run.vector("/tool", "position"), Configuration::current))
        << tilt;
  }
}

// A rim cuts into the triangles around the nodes that it presses; deeper than a tenth of an edge
// that is said. A right-angled rim that is d deep has a triangle d / sqrt(2) inside of it or more.
TEST(SmallTool, DoesNotCutDeepInSilence) {
  const Vec3 axis = Vec3(-0.394, 0.821, -0.824).normalized();
  TextRun run(contact +
                  "<node name='skin'><BlockMesh box='-8 -6 4.1 8 6 7.1 mm' cells='4 3 1'/><Tissue "
                  "name='tissue' young='9.8 kPa' poisson='0.3' velocity='0.13 -0.18 -0.8'/></node>"
                  "<Tool name='tool' shape='cylinder' radius='2.943 mm' length='3.391 mm' "
                  "axis='-0.394 0.821 -0.824' centre='-5.696 0.326 0 mm'/>"
                  "<Contact first='/skin/tissue' tool='tool' friction='0.826'/>",
              "gravity='0 0 0' dt='2 ms'");
  ASSERT_TRUE(run) << run.said();
  const auto& tissue = run.component<SolidBody>("/skin/tissue");
  // Mean edge of the triangles: of cells of 4, 4 and 3 mm with a diagonal in each side, 48
  // triangles of 4 by 4 and 28 of 4 by 3.
  const Real edge = (48 * (4 + 4 + 5.657) + 28 * (4 + 3 + 5)) / (3 * 76) * 1e-3;
  bool said = false;
  while (run.simulation().time() < 0.03 - 1e-9 && !said) {
    const StepReport& report = run.simulation().step();
    said = !report.solved || !report.faults.empty();
    const Real deep = rim_inside(tissue, Vec3(-5.696e-3, 0.326e-3, 0), axis, 2.943e-3, 3.391e-3);
    EXPECT_TRUE(said || deep < 0.1 * std::sqrt(2.) * edge) << report.time << ' ' << deep;
  }
}

// The same of a box that is a mesh: the fault is that of edges that stick through triangles. A
// corner brings three of them, so one crosses a triangle away from its border.
TEST(SmallTool, OfAMeshDoesNotCutDeepInSilence) {
  const Vec3 half(2.26325, 2.37141, 0.95444);  // mm
  const std::string file = SUTURA_BINARY_DIR "/small_box.obj";
  std::ofstream obj(file);
  for (int i = 0; i < 8; ++i)
    obj << "v " << (i & 1 ? 1 : -1) * half.x() << ' ' << (i & 2 ? 1 : -1) * half.y() << ' '
        << (i & 4 ? 1 : -1) * half.z() << '\n';
  obj << "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\n"
         "f 1 7 3\nf 2 4 8\nf 2 8 6\n";
  obj.close();
  TextRun run(
      contact +
          "<node name='skin'><BlockMesh box='-12 -8 -6 12 8 0 mm' cells='6 7 1'/><Tissue "
          "name='tissue' young='133.331 kPa' poisson='0.3' damping_stiffness='0'/><Attach name='a' "
          "box='-12 -8 -6 -12 8 0 mm'/><Attach name='b' box='12 -8 -6 12 8 0 mm'/></node><Track "
          "name='hand' times='0 0.003133 0.006266' positions='0 0 0 1.339 0.499 -6.917 2.018 0.012 "
          "-6.917 mm'/><Tool name='tool' shape='mesh' unit='mm' file='" +
          file +
          "' axis='-0.219 -0.973 0.880' centre='-4.881 3.268 3.746 mm' motion='hand'/><Contact "
          "first='/skin/tissue' tool='tool' friction='0.693'/>",
      "gravity='0 0 0' dt='2 ms'");
  ASSERT_TRUE(run) << run.said();
  const auto& tissue = run.component<SolidBody>("/skin/tissue");
  const auto& tool = run.component<Drawing>("/tool");
  // Mean edge: 84 quads of 4 by 2.286, 12 quads of 4 by 6, 14 quads of 2.286 by 6.
  const Real edge = (84 * (4 + 2.286 + 4.607) + 12 * (4 + 6 + 7.211) + 14 * (2.286 + 6 + 6.421)) /
                    (3 * 110) * 1e-3;
  bool said = false;
  while (run.simulation().time() < 0.1 - 1e-9 && !said) {
    const StepReport& report = run.simulation().step();
    said = !report.solved || !report.faults.empty();
    for (const Vec3& p : tool.geometry().points) {
      if (!tissue.locate(p, Configuration::current)) continue;
      const auto near = tissue.closest_surface(p, 1, Configuration::current);
      EXPECT_TRUE(said || std::abs(near->distance) < 0.25 * edge) << report.time;
    }
  }
}

}  // namespace
}  // namespace sutura::testing
