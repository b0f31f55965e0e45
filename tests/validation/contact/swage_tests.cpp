// Behind a needle the thread is thinner: the end of the needle touches with the needle's radius.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <ostream>

#include "contact_scenes.h"
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

/// What lies below z = 0.
struct Partner {
  std::string name, scene, contact;
  bool is_rigid = true;
  friend void PrintTo(const Partner& p, std::ostream* out) { *out << p.name; }
};

std::string pyramid_file() {
  const std::string file = SUTURA_BINARY_DIR "/pyramid.obj";
  std::ofstream(file) << "v -15 -15 0\nv 15 -15 0\nv 15 15 0\nv -15 15 0\nv 0 0 -15\n"
                         "f 1 2 3 4\nf 2 1 5\nf 3 2 5\nf 4 3 5\nf 1 4 5\n";
  return file;
}

class Swage : public ::testing::TestWithParam<Partner> {};

/// A straight needle, tilted so that its swage is its lowest point, is lowered until that is 0.05
/// mm nearer than it can be.
TEST_P(Swage, TouchesWithTheRadiusOfTheNeedle) {
  const Partner& partner = GetParam();
  const Real radius = 0.2e-3, length = 10e-3, held = 1e-3, way = 0.35e-3, bent = 0.05e-3;
  const Real tilt = 10 * std::numbers::pi / 180;
  const Vec3 back(std::cos(tilt), 0, -std::sin(tilt));
  const Vec3 tip = Vec3(0, 0, radius + way - bent) - length * back;
  TextRun run(
      "<plugin name='contact'/><SutureThread name='t' needle_length='10 mm' "
      "needle_angle='0' needle_diameter='0.4 mm' thread_diameter='0.05 mm' "
      "thread_length='10 mm' thread_beams='20' tip='" +
          text_of(tip) + "' tip_direction='" + text_of(-back) +
          "' plane_normal='0 1 0' thread_direction='1 0 0' damping_mass='20'/>" + partner.scene +
          "<Contact name='c' first='t' " + partner.contact +
          " friction='0'/><Track name='w' times='0.02 0.3' positions='0 0 0 " +
          text_of(Vec3(0, 0, -way)) + "'/><Grasper name='h' body='t' at='1 mm' track='w'/>",
      "dt='10 ms' gravity='0 0 0'");
  ASSERT_TRUE(run) << run.said();
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(run.simulation().step().solved) << i;
  EXPECT_NEAR(run.number("/c", "distance"), 0, 1e-2 * radius);
  // A cantilever from the jaws to the swage, of steel of 190 GPa; jaws give way by a percent. What
  // is not rigid bears less.
  const Real EI = 190e9 * std::numbers::pi * std::pow(radius, 4) / 4;
  const Real rigid = 3 * EI * bent / (std::pow(length - held, 3) * std::pow(std::cos(tilt), 2));
  const Real force = run.vector("/c", "force").z();
  if (partner.is_rigid) {
    EXPECT_NEAR(force, rigid, 0.02 * rigid);
  }
  EXPECT_GT(force, 0);
  EXPECT_LT(force, 1.02 * rigid);
}

INSTANTIATE_TEST_SUITE_P(
    Partners, Swage,
    ::testing::Values(
        Partner{"plane", "<Tool name='p' shape='plane'/>", "tool='p'"},
        Partner{"mesh", "<Tool name='p' shape='mesh' unit='mm' file='" + pyramid_file() + "'/>",
                "tool='p'"},
        Partner{"tissue",
                block("s", "-5.3 -5.7 -5 4.7 4.3 0", "4 4 2", "<Attach box='-6 -6 -5 6 6 -5 mm'/>"),
                "second='/s/tissue'", false},
        Partner{"thread",
                thread("b", Vec3(-0.01e-3, 0, -0.1e-3), Vec3::UnitY(), 10e-3, 20, "clamp='both'"),
                "second='b'", false}),
    [](const auto& i) { return i.param.name; });

}  // namespace
}  // namespace sutura::testing
