// The friction of a thread that is drawn through the channel which its needle has made, against the
// capstan: from the directions of the thread alone, without any force that a wall has measured.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "scenes/text_run.h"
#include "sutura/body.h"

namespace sutura::testing {
namespace {

constexpr Real mu = 0.25, pressure = 15e3, diameter = 0.12e-3;

/// A curved needle is turned through a block and drawn away, the thread after it. The thread is as
/// stiff against bending as nylon is.
std::string stitch(const std::string& spacing) {
  return "<node name='skin'><BlockMesh box='-10 -4 -8  10 4 0 mm' cells='10 4 4'/> "
         "<Tissue young='60 kPa' poisson='0.42' damping_stiffness='10 ms'/> "
         "<Attach box='-10 -4 -8  10 4 -8 mm'/></node>"
         "<SutureThread name='s' needle_length='17 mm' needle_angle='135 deg' "
         "needle_diameter='0.45 mm' needle_beams='12' thread_diameter='0.12 mm' "
         "thread_young='2.5 GPa' thread_length='60 mm' thread_beams='100' "
         "tip='-6.37 0 0.613 mm' tip_direction='0.469 0 -0.883' plane_normal='0 -1 0' "
         "thread_direction='-1 0.15 1' thread_bend_radius='10 mm' damping_mass='3 1/s'/>"
         "<Track name='way' about='s' easing='smooth' times='0.1 0.7 0.75 1.2 1.25 2 s' "
         "turns='0 124 124 235 235 235 deg' "
         "positions='0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 25 mm'/>"
         "<Grasper at='14.5 mm' track='way' release='0.73 s'/> "
         "<Grasper name='puller' at='1.2 mm' track='way' grasp='0.73 s'/>"
         "<SuturePath name='path' spacing='" +
         spacing +
         "'/> <Cutting threshold='0.08 N'/> <PathFriction coefficient='0.25' pressure='15 kPa' "
         "lateral_share='1'/> <Puncture threshold='0.2 N' exit_threshold='0.15 N' friction='0.2'/>";
}

/// dT = f ds + mu T dtheta from the loose end to the hand, which pulls along `pull`.
Real capstan(const CurveBody& thread, Real high, Real low, const Vec3& pull) {
  constexpr Real f = mu * pressure * std::numbers::pi * diameter;
  constexpr int parts = 500;
  const auto direction = [&](int i) -> Vec3 {
    if (i > parts) return pull.normalized();
    return -thread.tangent(high + (low - high) * i / parts, Configuration::current);
  };
  Real tension = 0;
  for (int i = 0; i <= parts; ++i) {
    if (i < parts) tension += f * (high - low) / parts;
    tension *= std::exp(mu * std::acos(std::clamp(direction(i).dot(direction(i + 1)), -1., 1.)));
  }
  return tension;
}

Real pull_of(const std::string& spacing, const std::string& dt) {
  TextRun run(stitch(spacing), "dt='" + dt + "' gravity='0 0 0'");
  EXPECT_TRUE(run) << run.said();
  if (!run) return 0;
  run.run(1.85);
  EXPECT_EQ(run.number("/puncture", "punctures"), 2);
  const Real high = run.number("/path", "entry_abscissa");
  const Real low = high - run.number("/path", "inserted_length");
  EXPECT_GT(low, 20e-3) << "the needle has left the tissue";
  const Vec3 hand = run.vector("/puller", "force");
  const Real expected = capstan(run.component<CurveBody>("/s"), high, low, hand);
  EXPECT_NEAR(hand.norm(), expected, 0.05 * expected) << "spacing " << spacing << ", step " << dt;
  return hand.norm();
}

TEST(DrawnThread, ACapstanAtEverySpacingAndStep) {
  const Real pull = pull_of("1 mm", "5 ms");
  // Without the turn of 150 degrees: the pressure alone, to which it adds a half.
  EXPECT_GT(pull, 1.4 * mu * pressure * std::numbers::pi * diameter * 13.5e-3);
  for (const std::string spacing : {"0.5 mm", "0.25 mm"})
    EXPECT_NEAR(pull_of(spacing, "5 ms"), pull, 0.05 * pull) << "spacing " << spacing;
  for (const std::string dt : {"10 ms", "2 ms"})
    EXPECT_NEAR(pull_of("1 mm", dt), pull, 0.05 * pull) << "step " << dt;
}

constexpr Real bend_radius = 2.5e-3, straight = 12e-3;
constexpr Real bent = 2 * (straight + std::numbers::pi * bend_radius);  // length of that thread (m)

/// A limp thread lies in two half circles, bent opposite ways, in a block that is held all over.
std::string two_bends(const std::string& cells, const std::string& young = "2 GPa",
                      const std::string& pressure = "0 Pa") {
  const std::string test = ::testing::UnitTest::GetInstance()->current_test_info()->name();
  const std::string file = ::testing::TempDir() + "drawn_thread_" + test + ".csv";
  std::ofstream table(file);
  table << "s [m],curvature [1/m],side_curvature [1/m]\n";
  constexpr int parts = 800;
  for (int i = 0; i <= parts; ++i) {
    const Real s = bent * i / parts;
    const bool first = s > straight && s <= bent / 2, second = s > bent / 2;
    const int sign = first ? -1 : second && s < bent - straight ? 1 : 0;
    table << s << ',' << sign / bend_radius << ",0\n";
  }
  return "<BlockMesh box='-6 -3 -12  6 3 0 mm' cells='" + cells +
         "'/><Tissue young='50 kPa'/><Attach box='-6 -3 -12  6 3 0 mm'/>"
         "<SutureThread name='s' needle_length='0' thread_diameter='0.1 mm' thread_young='" +
         young + "' bending_factor='0.005' thread_length='" + std::to_string(bent * 1e3) +
         " mm' thread_beams='250' tip='-5 0 6 mm' tip_direction='0 0 1' plane_normal='0 -1 0' "
         "damping_stiffness='0.1 ms' damping_mass='100 1/s' thread_start_file='" +
         file +
         "'/><SuturePath sewn='true' spacing='0.25 mm'/><PathFriction coefficient='0.2' "
         "lateral_share='1' pressure='" +
         pressure + "'/>";
}

/// Its hand draws against a load. Right is e^(mu angle), whatever the mesh: the bends are no
/// further apart than an element is long.
Real pull_through(const std::string& bends) {
  TextRun run(bends +
                  "<ThreadLoad at='0' force='0 0 0.1 N' times='0 0.1 s' factors='0 1'/>"
                  "<Track name='way' times='0.2 0.6 s' positions='0 0 0  0 0 -1.5 mm'/>"
                  "<Grasper name='hand' at='" +
                  std::to_string(bent * 1e3) + " mm' track='way' rotation_stiffness='0'/>",
              "dt='10 ms' gravity='0 0 0'");
  EXPECT_TRUE(run) << run.said();
  if (!run) return 0;
  run.run(0.55);
  return run.vector("/hand", "force").norm() / 0.1;
}

// A twentieth: the thread cuts its corners where the bends begin and end, within a millimetre.
TEST(DrawnThread, BendsThatGoOppositeWaysAddUp) {
  const Real right = std::exp(0.2 * 2 * std::numbers::pi);
  for (const char* cells : {"12 6 12", "4 2 4"})
    EXPECT_NEAR(pull_through(two_bends(cells)), right, 0.05 * right) << cells;
  // A limit of stretch that bears nearly all is tension as much.
  const Real locked =
      pull_through(two_bends("12 6 12", "100 MPa") + "<Elongation limit='0.0005'/>");
  EXPECT_NEAR(locked, right, 0.05 * right);
}

// Loads of 50 and 100 mN at its ends, which such bends hold up to 1 : 3.5, become ten times as
// large within a millisecond or a tenth of a second. Held by the friction of the step before, the
// thread slid by 0.9 mm in the first case.
TEST(DrawnThread, IsHeldByTheFrictionOfTheLoadsThatItHas) {
  const auto tip_after = [](const std::string& until) {
    const auto load = [&](const std::string& at, const std::string& force) {
      return "<ThreadLoad name='at" + at.substr(0, 1) + "' at='" + at + "' force='" + force +
             "' times='0 0.1 0.3 " + until + " s' factors='0 0.05 0.05 0.5'/>";
    };
    TextRun run(two_bends("12 6 12", "2 GPa", "10 kPa") + load("0", "0 0 1 N") +
                    load(std::to_string(bent * 1e3) + " mm", "0 0 -2 N"),
                "dt='2 ms' gravity='0 0 0'");
    EXPECT_TRUE(run) << run.said();
    if (!run) return Real(0);
    run.run(0.6);
    return run.vector("/s", "tip_position").z();
  };
  // A step of 2 ms is a while of its own: by so much it slides before it is held.
  EXPECT_NEAR(tip_after("0.301"), tip_after("0.4"), 0.05e-3);
}

}  // namespace
}  // namespace sutura::testing
