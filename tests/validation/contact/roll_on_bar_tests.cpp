// A bent thread that rolls on a bar: nothing resists that, however far it rolls in a step.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

struct RollOnBar {
  const char* dt;
  const char* beams;
  Real most;  ///< that the pull of the hand may change by, as a share
};

class ThreadOnBar : public ::testing::TestWithParam<RollOnBar> {};

// A thread lies half round a bar, drawn by 0.3 N at one end and held at the other by a hand in
// which it is free to turn. The bar goes along its axis by 16 mm, so the thread turns by 4 rad
// in a mean step of 10 ms. It has nothing that would hold it back: the bar feels nothing along its
// axis, and the hand what it felt before.
//
// What the nodes lack of balance about the tangents may be a friction of 0.0001, the default
// tolerance of 0.01 times 0.01, of the 0.9 N that press the thread on the bar. With a limit for
// each node alone 44 mN were left at 10 ms and 184 with 240 beams; the hand pulled 3.8 and 9 times
// as much as before. Where only nodes counted that turn at the guess, a guess at which the thread
// is dragged was taken at 20 ms.
TEST_P(ThreadOnBar, RollsFreely) {
  const RollOnBar& c = GetParam();
  const std::string start = ::testing::TempDir() + "roll_on_bar_" + c.beams + "_" +
                            std::to_string(c.most) + c.dt[0] + ".csv";
  std::ofstream(start) << "s [mm], curvature [1/m], torsion [1/m]\n0, 0, 0\n"
                          "12, 322.58064516, 0\n21.738937226, 0, 0\n";
  TextRun run(
      "<plugin name='contact'/>"
      "<SutureThread name='thread' needle_length='0' thread_length='33.738937228 mm' "
      "thread_diameter='0.2 mm' thread_young='2 GPa' tip='-12 0 0 mm' tip_direction='-1 0 0' "
      "plane_normal='0 -1 0' damping_mass='10 1/s' thread_beams='" +
          std::string(c.beams) + "' thread_start_file='" + start +
          "'/><Track name='way' easing='smooth' times='0.25 0.65 s' positions='0 0 0  0 16 0 mm'/>"
          "<Tool name='bar' shape='cylinder' axis='0 1 0' radius='3 mm' length='60 mm' "
          "centre='0 0 -3.1 mm' motion='way'/><Contact tool='bar' friction='0.4'/>"
          "<ThreadLoad at='0' force='-0.3 0 0 N' times='0 0.1 s' factors='0 1'/>"
          "<Track name='pull' easing='smooth' times='0.12 0.2 s' positions='0 0 0  -0.004 0 0 mm'/>"
          "<Grasper name='hand' at='33.738937228 mm' track='pull' rotation_stiffness='0'/>",
      std::string("gravity='0 0 0' dt='") + c.dt + "'");
  ASSERT_TRUE(run) << run.said();
  run.run(0.24);
  const Real before = run.vector("/hand", "force").norm();
  Real most = before, drag = 0;
  while (run.simulation().time() < 0.65 - 1e-9) {
    EXPECT_FALSE(run.simulation().step().missed()) << run.simulation().time();
    most = std::max(most, run.vector("/hand", "force").norm());
    drag = std::max(drag, std::abs(run.vector("/bar", "force").y()));
  }
  EXPECT_LT(drag, 1e-3);
  EXPECT_LT(most, (1 + c.most) * before);
}

// At 1 ms the hand feels 1 % more while the bar moves. The rest of the bounds is for a drag within
// its tolerance: it turns the thread askew, and one that rolls askew is drawn along itself.
INSTANTIATE_TEST_SUITE_P(AtAnyStepAndAnyBeams, ThreadOnBar,
                         ::testing::Values(RollOnBar{"5 ms", "120", 0.03},
                                           RollOnBar{"10 ms", "120", 0.04},
                                           RollOnBar{"10 ms", "240", 0.04},
                                           RollOnBar{"20 ms", "120", 0.1}));

std::string text(Real x) {
  char out[32];
  std::snprintf(out, sizeof out, "%.12g", x);
  return out;
}

/// A bar along y, 60 mm long, as a closed mesh of 48 sides (mm).
void write_bar(const std::string& file, Real radius) {
  constexpr int sides = 48, rings = 12;
  std::ofstream out(file);
  for (int j = 0; j <= rings; ++j)
    for (int i = 0; i < sides; ++i) {
      const Real angle = 2 * std::numbers::pi * i / sides;
      out << "v " << radius * std::cos(angle) << ' ' << -30 + 60. * j / rings << ' '
          << radius * std::sin(angle) << '\n';
    }
  out << "v 0 -30 0\nv 0 30 0\n";
  const int foot = sides * (rings + 1) + 1, head = foot + 1;
  for (int i = 0; i < sides; ++i) {
    const int next = (i + 1) % sides;
    for (int j = 0; j < rings; ++j) {
      const int a = j * sides + i + 1, b = j * sides + next + 1;
      out << "f " << a << ' ' << a + sides << ' ' << b << '\n';
      out << "f " << b << ' ' << a + sides << ' ' << b + sides << '\n';
    }
    out << "f " << foot << ' ' << i + 1 << ' ' << next + 1 << '\n';
    out << "f " << head << ' ' << rings * sides + next + 1 << ' ' << rings * sides + i + 1 << '\n';
  }
}

struct NearSlip {
  const char* name;
  bool is_mesh;
  Real diameter, young, force, friction, radius;  // mm, GPa, N, 1, mm: of the bar
  Real duration;                                  // s, of 16 mm
  Real most;  ///< that the pull of the hand may change by, as a share
};

class ThreadNearSlip : public ::testing::TestWithParam<NearSlip> {};

// Along most of the bar the thread is at the limit of its friction. Where it rolls it does not
// slip, but what a step misses of that was taken for slip, up to 1 um of it: it turned friction
// away from the thread, which slid along itself until the hand pulled up to twice as much.
TEST_P(ThreadNearSlip, RollsFreely) {
  const NearSlip& c = GetParam();
  const std::string folder = ::testing::TempDir() + "roll_near_slip_" + c.name;
  const Real bend = c.radius + c.diameter / 2, arc = std::numbers::pi * bend;
  std::ofstream(folder + ".csv") << "s [mm], curvature [1/m], torsion [1/m]\n0, 0, 0\n12, "
                                 << text(1000 / bend) << ", 0\n"
                                 << text(12 + arc) << ", 0, 0\n";
  if (c.is_mesh) write_bar(folder + ".obj", c.radius);
  const std::string bar =
      c.is_mesh ? "shape='mesh' unit='mm' file='" + folder + ".obj'"
                : "shape='cylinder' axis='0 1 0' length='60 mm' radius='" + text(c.radius) + " mm'";
  TextRun run(
      "<plugin name='contact'/>"
      "<SutureThread name='thread' needle_length='0' thread_length='" +
          text(24 + arc) + " mm' thread_diameter='" + text(c.diameter) + " mm' thread_young='" +
          text(c.young) +
          " GPa' tip='-12 0 0 mm' tip_direction='-1 0 0' plane_normal='0 -1 0' "
          "damping_mass='10 1/s' thread_beams='120' thread_start_file='" +
          folder + ".csv'/><Track name='way' easing='smooth' times='0.25 " +
          text(0.25 + c.duration) + " s' positions='0 0 0  0 16 0 mm'/><Tool name='bar' " + bar +
          " centre='0 0 -" + text(bend) + " mm' motion='way'/><Contact tool='bar' friction='" +
          text(c.friction) + "'/><ThreadLoad at='0' force='-" + text(c.force) +
          " 0 0 N' times='0 0.1 s' factors='0 1'/>"
          "<Track name='pull' easing='smooth' times='0.12 0.2 s' positions='0 0 0  -0.004 0 0 mm'/>"
          "<Grasper name='hand' at='" +
          text(24 + arc) + " mm' track='pull' rotation_stiffness='0'/>",
      "gravity='0 0 0' dt='2.5 ms'");
  ASSERT_TRUE(run) << run.said();
  run.run(0.24);
  const Real before = run.vector("/hand", "force").norm();
  while (run.simulation().time() < 0.25 + c.duration) {
    EXPECT_FALSE(run.simulation().step().missed()) << run.simulation().time();
    EXPECT_NEAR(run.vector("/hand", "force").norm(), before, c.most * before);
  }
}

// What is left differs from thread to thread. Six whose moduli differ by up to half a percent
// change their pull by 0.4 to 13 % on the cylinder (43 to 117 % before) and by 5 to 9 % on the mesh
// (29 to 70 %): the bounds are between the two.
INSTANTIATE_TEST_SUITE_P(
    OnToolsOfBothKinds, ThreadNearSlip,
    ::testing::Values(NearSlip{"cylinder", false, 0.437, 1.56, 6.7729, 1, 2.07, 1.0458, 0.25},
                      NearSlip{"mesh", true, 0.043, 3.18, 0.0545, 0.64, 3.11, 0.3791, 0.15}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace sutura::testing
