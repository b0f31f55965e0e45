// A needle that goes into tissue close to an edge of it: its footprint reaches over the edge, and
// what happens must not depend on how the scene stands in the world.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sutura/text.h"
#include "sutura/units.h"
#include "text_run.h"

namespace sutura::testing {
namespace {

struct Entry {
  int step = 0;  // in which it went in; 0: never
  Real inserted = 0;
};

std::string text(const Vec3& v) {
  return format_real(v.x()) + " " + format_real(v.y()) + " " + format_real(v.z());
}

/// 20 x 16 x 7 mm, its top at z = 0 and its base held, all of it turned.
std::string block(const Mat3& turn, int nx, int ny, int nz, const std::string& tissue) {
  std::string corners, base;
  for (const Real z : {-7e-3, 0.})
    for (const Real y : {-8e-3, 8e-3})
      for (const Real x : {-10e-3, 10e-3}) corners += " " + text(turn * Vec3(x, y, z));
  for (int node = 0; node < (nx + 1) * (ny + 1); ++node) base += " " + std::to_string(node);
  return "<BlockMesh corners='" + corners + "' cells='" + std::to_string(nx) + " " +
         std::to_string(ny) + " " + std::to_string(nz) + "'/><Tissue " + tissue +
         " element='t4' damping_stiffness='2 ms'/><Attach nodes='" + base + "'/>";
}

/// A straight needle, 1.7 degrees from the normal, driven 6 mm into a block 1 mm from its edge, all
/// of it turned.
Entry entry(const Mat3& turn, Real dt) {
  const auto turned = [&](Real x, Real y, Real z) { return text(turn * Vec3(x, y, z)); };  // m
  const Real lean = 0.03;                                                                  // rad
  const Real c = std::cos(lean), s = std::sin(lean);
  TextRun run(
      block(turn, 10, 8, 6, "young='30 kPa' poisson='0.45'") +
          "<SutureThread name='w' needle_length='40 mm' needle_angle='0' needle_diameter='0.5 mm' "
          "tip='" +
          turned(9e-3, 0.3e-3, 1e-3) + "' tip_direction='" + turned(s, 0, -c) + "' plane_normal='" +
          turned(0, 1, 0) +
          "' thread_length='20 mm' thread_beams='10'/>"
          "<Track times='0 1 s' positions='0 0 0 " +
          turned(6e-3 * s, 0, -6e-3 * c) +
          "'/><Grasper at='38 mm'/><SuturePath name='path' spacing='1 mm'/>"
          "<Puncture name='puncture' threshold='0.1 N' friction='0.2'/><Cutting threshold='0.03 "
          "N'/>"
          "<PathFriction coefficient='0.2' pressure='5 kPa'/>",
      "gravity='0 0 0' dt='" + format_real(dt) + " s'");
  EXPECT_TRUE(run) << run.said();
  Entry found;
  while (run && run.simulation().time() < 1.2) {
    EXPECT_TRUE(run.simulation().step().solved);
    if (found.step == 0 && run.number("/puncture", "punctures") > 0)
      found.step = static_cast<int>(run.simulation().report().step);
  }
  EXPECT_EQ(run.number("/puncture", "punctures"), 1);
  found.inserted = run.number("/path", "inserted_length");
  return found;
}

TEST(BesideAnEdge, ANeedleGoesInAlikeHoweverTheSceneStands) {
  const Real dt = 10e-3;
  const Entry upright = entry(Mat3::Identity(), dt);
  EXPECT_GT(upright.step, 0);
  const auto turn = [](Real angle, const Vec3& axis) {
    return Eigen::AngleAxisd(angle, axis.normalized()).matrix();
  };
  for (const Mat3& t :
       {turn(1e-9, {1, 0, 0}), turn(0.1, {0, 1, 0}), turn(0.3, {1, 0, 0}), turn(2, {1, 2, 3})}) {
    const Entry other = entry(t, dt);
    EXPECT_NEAR(other.step, upright.step, 1);
    // The tip slides before it goes in, and rounding grows meanwhile; a thousandth of the spacing
    // of samples is left. Where the side of the block was taken for its top, it was millimetres.
    EXPECT_NEAR(other.inserted, upright.inserted, 2e-6);
  }
}

/// A thin needle presses a soft block 0.3 mm from its edge, 1.5 mm from a corner, and pushes the
/// edge aside. What it would come out of if it went in, the side of the block, stands before it
/// then as well as the edge. Taken for a second wall, it made both forces grow up to the threshold.
TEST(BesideAnEdge, ATipThatSlidesOffDoesNotGoIn) {
  const Real threshold = 0.05;
  for (const Mat3& turn :
       {Mat3(Mat3::Identity()), Eigen::AngleAxisd(2, Vec3(1, 2, 3).normalized()).matrix()}) {
    const auto turned = [&](Real x, Real y, Real z) { return text(turn * Vec3(x, y, z)); };  // m
    TextRun run(block(turn, 12, 9, 5, "young='20 kPa' poisson='0.3'") +
                    "<SutureThread name='w' needle_length='40 mm' needle_angle='0' "
                    "needle_diameter='0.3 mm' tip='" +
                    turned(9.7e-3, 6.5e-3, 0.5e-3) + "' tip_direction='" + turned(0, 0, -1) +
                    "' plane_normal='" + turned(0, 1, 0) +
                    "' thread_length='20 mm' thread_beams='10'/><Track times='0 0.35 s' "
                    "positions='0 0 0 " +
                    turned(0, 0, -3.8e-3) +
                    "'/><Grasper at='38 mm'/><SuturePath spacing='1 mm'/><Puncture threshold='" +
                    format_real(threshold) + " N' friction='0.1'/><Cutting threshold='0.015 N'/>",
                "gravity='0 0 0' dt='1 ms'");
    ASSERT_TRUE(run) << run.said();
    Real largest = 0;
    while (run.simulation().time() < 0.35 - 1e-9) {
      const StepReport& report = run.simulation().step();
      EXPECT_FALSE(report.missed()) << report.step;
      largest = std::max(largest, run.number("/puncture", "force"));
    }
    EXPECT_LT(largest, 0.5 * threshold);  // that of a block that gives way at its edge
    EXPECT_GT(largest, 0);
    EXPECT_EQ(run.number("/puncture", "punctures"), 0);
    EXPECT_LT(run.number("/puncture", "peak_force"), threshold);
  }
}

/// A thick needle that slides towards a corner, with a footprint wider than its way to the edges.
/// As points of that pass from the top to the sides its normal turns by ten degrees at once, while
/// their mean is a millimetre away from the tip. (When they do, rounding decides: in this
/// orientation.)
TEST(BesideAnEdge, AFootprintThatReachesOverACornerDoesNotLiftTheTip) {
  const Real threshold = 0.1;
  const Mat3 turn = Eigen::AngleAxisd(0.3, Vec3::UnitX()).toRotationMatrix();
  const auto turned = [&](const Vec3& v) { return text(turn * v); };
  const Real x = 0.13, y = 0.218;
  const Vec3 axis(x, y, -std::sqrt(1 - x * x - y * y)), normal(0, -axis.z(), axis.y());
  TextRun run(block(turn, 12, 9, 5, "young='30 kPa' poisson='0.4'") +
                  "<SutureThread name='w' needle_length='40 mm' needle_angle='0' "
                  "needle_diameter='0.7 mm' tip='" +
                  turned({8.435e-3, 6.39e-3, 0.484e-3}) + "' tip_direction='" + turned(axis) +
                  "' plane_normal='" + turned(normal) +
                  "' thread_length='20 mm' thread_beams='10'/><Track times='0 0.427 s' "
                  "positions='0 0 0 " +
                  turned(2.85e-3 * axis) +
                  "'/><Grasper at='38 mm'/><SuturePath spacing='1 mm'/><Puncture threshold='" +
                  format_real(threshold) + " N' friction='0'/><Cutting threshold='0.03 N'/>",
              "gravity='0 0 0' dt='1 ms'");
  ASSERT_TRUE(run) << run.said();
  Real largest = 0, before = 0;
  while (run.simulation().time() < 0.427 - 1e-9) {
    const StepReport& report = run.simulation().step();
    EXPECT_FALSE(report.missed()) << report.step;
    const Real force = run.number("/puncture", "force");
    // The hand moves by 7 um a step, the tissue is dented by 3 mm. A tenth of the threshold is what
    // the turned normal bends the needle aside by; the place was lifted by 0.2 mm.
    EXPECT_LT(force, before + 0.1 * threshold) << report.step;
    before = force;
    largest = std::max(largest, force);
  }
  EXPECT_GT(largest, 0.9 * threshold);
  EXPECT_EQ(run.number("/puncture", "punctures"), 0);
}

}  // namespace
}  // namespace sutura::testing
