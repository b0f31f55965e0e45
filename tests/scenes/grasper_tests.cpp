// A grasper lifts a thread by its end, swings it and lets go: what the CSV says of its force must
// be what moves the thread.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "csv.h"
#include "house/command.h"

namespace sutura::testing {
namespace {

constexpr double dt = 0.01;  // s
constexpr const char* scene = R"(<sutura version="1" dt="10 ms" gravity="0 0 -9.81" duration="2 s">
  <plugin name="thread"/> <plugin name="tools"/> <plugin name="output"/>
  <SutureThread name="suture" needle_length="0" thread_length="100 mm" thread_diameter="0.175 mm"
                thread_density="910" tip="0 0 0" tip_direction="0 0 1" plane_normal="0 1 0"/>
  <Track times="0.5 1.2 s" positions="0 0 0  40 0 20 mm" rotations="0 0 0  0 90 0 deg"
         easing="smooth"/>
  <Grasper name="jaws" at="0" grasp="0 s" release="1.5 s"/>
  <CsvProbe columns="/jaws.force /jaws.holding /jaws.target /suture.momentum /suture.tip_position"/>
</sutura>)";

// 4-0 polypropylene, 100 mm.
constexpr double mass = 910 * std::numbers::pi * 0.0875e-3 * 0.0875e-3 * 0.1;
constexpr double weight = mass * 9.81;
constexpr double grip = 1e6;  // N/m, the default

class GrasperScene : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const house::TemporaryFolder folder("grasper");
    std::ofstream(folder.path() / "scene.xml") << scene;
    const house::Outcome outcome = house::command("run " + (folder.path() / "scene.xml").string() +
                                                  " --output " + folder.path().string());
    ASSERT_EQ(outcome.code, 0) << outcome.text;
    table_ = read_csv((folder.path() / "probe.csv").string());
    ASSERT_EQ(table_.rows.size(), 201u);
  }
  static double at(std::size_t row, const std::string& column) {
    return table_.number(row, column);
  }
  static Table table_;
};
Table GrasperScene::table_;

TEST_F(GrasperScene, HoldsTheWeightAtRest) {
  // Hung vertically from the start, the thread only bounces along its axis, which implicit Euler
  // damps out in a few steps.
  EXPECT_NEAR(at(50, "jaws.force.z [N]"), weight, 1e-4 * weight);
  EXPECT_NEAR(at(50, "jaws.force.x [N]"), 0, 1e-4 * weight);
}

// Implicit Euler: p(n+1) - p(n) = dt (F - weight), in every step, held or not. Inner forces cancel.
TEST_F(GrasperScene, ForceAndWeightAreWhatChangesMomentum) {
  const char* force[] = {"jaws.force.x [N]", "jaws.force.y [N]", "jaws.force.z [N]"};
  const char* momentum[] = {"suture.momentum.x [kg m/s]", "suture.momentum.y [kg m/s]",
                            "suture.momentum.z [kg m/s]"};
  for (std::size_t n = 1; n < table_.rows.size(); ++n) {
    for (int i = 0; i < 3; ++i) {
      const double change = at(n, momentum[i]) - at(n - 1, momentum[i]);
      const double applied = dt * (at(n, force[i]) - (i == 2 ? weight : 0));
      // Exact but for what the passes leave, most in the step after the release, when the stretched
      // thread snaps back.
      EXPECT_NEAR(change, applied, 1e-4 * weight * dt) << "step " << n << " axis " << i;
    }
  }
}

TEST_F(GrasperScene, TheSectionIsWhereTheJawsAre) {
  const char* tip[] = {"suture.tip_position.x [m]", "suture.tip_position.y [m]",
                       "suture.tip_position.z [m]"};
  const char* target[] = {"jaws.target.x [m]", "jaws.target.y [m]", "jaws.target.z [m]"};
  const char* force[] = {"jaws.force.x [N]", "jaws.force.y [N]", "jaws.force.z [N]"};
  for (std::size_t n = 1; n <= 150; ++n) {
    double apart = 0, pull = 0;
    for (int i = 0; i < 3; ++i) {
      apart = std::hypot(apart, at(n, tip[i]) - at(n, target[i]));
      pull = std::hypot(pull, at(n, force[i]));
    }
    // Spring: apart = pull / grip; 1e-12 m of rounding.
    EXPECT_NEAR(apart, pull / grip, 0.01 * pull / grip + 1e-12) << "step " << n;
  }
}

TEST_F(GrasperScene, LetsGoOnTime) {
  EXPECT_EQ(at(150, "jaws.holding"), 1);  // the step that ends at 1.5 s
  EXPECT_EQ(at(151, "jaws.holding"), 0);
  EXPECT_EQ(at(151, "jaws.force.z [N]"), 0);
  EXPECT_LT(at(200, "suture.tip_position.z [m]"), at(150, "suture.tip_position.z [m]") - 1);
}

}  // namespace
}  // namespace sutura::testing
