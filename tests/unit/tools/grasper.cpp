// Track and Grasper in a scene, on a rod that obeys exactly: what is asked for is what is tested.
#include "grasper.h"

#include <gtest/gtest.h>

#include <fstream>
#include <numbers>

#include "unit/tools/loaded.h"

namespace sutura::tools {
namespace {

constexpr Real pi = std::numbers::pi;

TEST(Grasper, NothingMovesWhenTheJawsClose) {
  const Running s(
      "<Curve name='rod' length='100 mm' origin='3 4 5 mm'/>"
      "<Track name='tool' times='0' positions='70 -20 9 mm' rotations='0.3 0.2 -1'/>"
      "<Grasper name='jaws' at='30 mm'/>");
  s.step();
  EXPECT_TRUE(s.rod().held());
  EXPECT_LT((s.point(0) - Vec3(3e-3, 4e-3, 5e-3)).norm(), rounding);
  EXPECT_LT((s.along() - Vec3::UnitX()).norm(), rounding);
}

TEST(Grasper, CarriesTheSectionAlongTheArc) {
  const Running s(
      "<Curve name='rod' length='100 mm'/>"
      "<Track name='tool' times='0 1 s' rotations='0 0 0  0 0 90 deg' centre='0 50 0 mm'/>"
      "<Grasper name='jaws' at='40 mm'/>");
  const Vec3 centre(0, 0.05, 0);
  for (int step = 1; step <= 12; ++step) {
    s.step();
    const Real angle = pi / 2 * std::min(0.1 * step, 1.0);
    const Eigen::AngleAxis<Real> turn(angle, Vec3::UnitZ());
    const Vec3 expected = centre + turn * (Vec3(0.04, 0, 0) - centre);
    EXPECT_LT((s.point(0.04) - expected).norm(), rounding) << step;
    EXPECT_LT((s.along() - turn * Vec3::UnitX()).norm(), rounding);
    EXPECT_LT((s.output<Vec3>("/jaws", "target") - expected).norm(), rounding);
  }
}

TEST(Grasper, LetsGoAndGraspsAgainWithoutAJump) {
  const Running s(
      "<Curve name='rod' length='100 mm'/>"
      "<Track name='tool' times='0 1 s' positions='0 0 0  10 0 0 mm'/>"
      "<Grasper name='jaws' at='0 mm' grasp='0 0.6 s' release='0.3 s' stiffness='2 kN/m'"
      " rotation_stiffness='0.5 N m/rad'/>");
  // Held in steps 1 to 3 and from step 7: 1 mm per step with the tool, none without.
  const Real expected_mm[] = {1, 2, 3, 3, 3, 3, 4, 5, 6, 7, 7};
  for (int step = 1; step <= 11; ++step) {
    s.step();
    EXPECT_NEAR(s.point(0).x(), 1e-3 * expected_mm[step - 1], rounding) << step;
    const bool held = step <= 3 || step >= 7;
    EXPECT_EQ(s.output<Real>("/jaws", "holding"), held ? 1 : 0) << step;
    EXPECT_EQ(s.output<Vec3>("/jaws", "force"),
              held ? fake::Curve::applied().force : Vec3(Vec3::Zero()));
    EXPECT_EQ(s.output<Vec3>("/jaws", "moment"),
              held ? fake::Curve::applied().moment : Vec3(Vec3::Zero()));
  }
  EXPECT_EQ(s.rod().stiffness().translation, 2000);
  EXPECT_EQ(s.rod().stiffness().rotation, 0.5);
}

// The tool goes on at 10 mm/s; steps are 0.1 s. An event within a sixteenth of a step before its
// end happens that much before it.
TEST(Grasper, LetsGoAndGraspsWithinAStep) {
  const Running s(
      "<Curve name='rod' length='100 mm'/>"
      "<Track name='tool' times='0 2 s' positions='0 0 0  20 0 0 mm'/>"
      "<Grasper name='jaws' at='0 mm' grasp='0 0.575 0.997 s' release='0.34 0.75 s'/>");
  const Real expected_mm[] = {1, 2, 3, 3.4, 3.4, 3.65, 4.65, 5.15, 5.15, 5.2125, 6.2125};
  for (int step = 1; step <= 11; ++step) {
    s.step();
    EXPECT_NEAR(s.point(0).x(), 1e-3 * expected_mm[step - 1], rounding) << step;
  }
}

TEST(Grasper, DrawsTheSectionToItsOwnPlaceWhileItCloses) {
  const Running s(
      "<Curve name='rod' length='100 mm'/>"
      "<Track name='tool' times='0.5 0.7 s' positions='40 8 0  40 8 6 mm'/>"
      "<Grasper name='jaws' at='40 mm' grasp='0.2 s' closing='0.4 s'/>");
  // Of 8 mm aside a quarter in each step from the third on; the tool rises from 0.5 s on.
  const Real aside_mm[] = {0, 0, 2, 4, 6, 8, 8, 8}, high_mm[] = {0, 0, 0, 0, 0, 3, 6, 6};
  for (int step = 0; step < 8; ++step) {
    s.step();
    const Vec3 expected(40e-3, 1e-3 * aside_mm[step], 1e-3 * high_mm[step]);
    EXPECT_LT((s.point(0.04) - expected).norm(), rounding) << step;
  }
}

TEST(Track, ReadsACsvFileBesideTheScene) {
  const std::filesystem::path folder = testing::TempDir();
  std::ofstream(folder / "sutura_track.csv") << "t [s], z [mm]\n0, 0\n1, 10\n";
  const Running s("<Track name='tool' file='sutura_track.csv' centre='1 0 0 m'/>", folder);
  s.step();
  EXPECT_LT((s.output<Vec3>("/tool", "position") - Vec3(1, 0, 1e-3)).norm(), rounding);
}

TEST(Track, AMalformedFileIsNamedWithItsLine) {
  const std::filesystem::path folder = testing::TempDir();
  std::ofstream(folder / "sutura_bad_track.csv") << "t [s], z [mm]\n0, 0\n1, ten\n";
  const Loaded s("<Track name='tool' file='sutura_bad_track.csv'/>", folder);
  EXPECT_FALSE(s.simulation);
  EXPECT_NE(s.messages().find("sutura_bad_track.csv:3: error: [/tool] 'ten'"), std::string::npos)
      << s.messages();
  EXPECT_EQ(s.diagnostics.exit_code(), static_cast<int>(Category::file));
}

struct Wrong {
  const char* elements;
  const char* says;
};
class WrongTools : public testing::TestWithParam<Wrong> {};

TEST_P(WrongTools, AreErrorsThatSayWhatWasExpected) {
  const Loaded s(GetParam().elements);
  EXPECT_FALSE(s.simulation);
  EXPECT_NE(s.messages().find(GetParam().says), std::string::npos) << s.messages();
}

INSTANTIATE_TEST_SUITE_P(
    Tools, WrongTools,
    testing::Values(
        Wrong{"<Track/>", "no key frames"},
        Wrong{"<Track times='0 1'  positions='0 0 0'/>", "has 3 numbers; expected three for each"},
        Wrong{"<Track times='0 1'  rotations='0 0 0 1'/>", "'rotations' has 4"},
        Wrong{"<Track times='1 0'  positions='0 0 0 0 0 0'/>", "times must increase"},
        Wrong{"<Track times='0 s' file='a.csv'/>", "given twice"},
        Wrong{"<Track file='sutura_no_such_file.csv'/>", "no such file"},
        Wrong{"<Track times='0 mm'/>", "mm"},
        Wrong{"<Curve length='10 mm'/><Track times='0'/><Grasper at='11 mm'/>", "0.01 m long"},
        Wrong{"<Curve/><Track times='0'/><Grasper grasp='1' release='0.5'/>", "release at 0.5 s"},
        Wrong{"<Curve/><Track times='0'/><Grasper grasp='0 1 2'/>", "3 times of grasp"},
        Wrong{"<Curve/><Grasper/>", "Track"}, Wrong{"<Track times='0'/><Grasper/>", "CurveBody"}));

}  // namespace
}  // namespace sutura::tools
