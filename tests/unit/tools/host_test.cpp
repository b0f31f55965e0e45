// Tools led by a host: by inputs that are described, and by the functions of tool.h.
#include <Eigen/Geometry>
#include <numbers>

#include "sutura/tool.h"
#include "unit/tools/loaded.h"

namespace sutura::tools {
namespace {

const std::string scene =
    "<Curve name='rod' length='100 mm'/>"
    "<Grasper name='jaws' at='40 mm'/>"  // before its track: drivers follow links
    "<Track name='tool' times='0 1 s' positions='0 0 0  10 0 5 mm' rotations='0 0 0  0 0 90 deg'"
    " centre='0 50 0 mm'/>";

TEST(Host, WhoTellsTheTrackWhatItsKeysSayChangesNothing) {
  const Running keys(scene), told(scene);
  for (int step = 1; step <= 12; ++step) {
    const Real u = std::min(0.1 * step, 1.0);
    EXPECT_EQ(told.set("/tool.position", Vec3(0.01 * u, 0.05, 0.005 * u)), "");
    EXPECT_EQ(told.set("/tool.rotation", Vec3(0, 0, u * std::numbers::pi / 2)), "");
    keys.step();
    told.step();
    for (const Real s : {0.0, 0.1}) {
      const Vec3 expected = keys.point(s);
      EXPECT_LT((told.point(s) - expected).norm(), rounding) << step;
    }
  }
}

// A tool that is told to turn goes about its centre on the way, too, which counts where jaws open
// within a step. Led straight between two poses, a centre at 2 m went aside by 22 mm half way.
TEST(Host, TheWayOfAToldTurnIsTheSameWhereverTheSceneStands) {
  for (const char* x : {"0", "2"}) {
    const Running s("<Curve name='rod'/><Track name='tool' times='0' centre='" + std::string(x) +
                    " 0 0 m'/>");
    const Vec3 centre(std::stod(x), 0, 0), arm(0.01, 0.02, 0.03);
    const auto* tool = dynamic_cast<const Tool*>(s.simulation->find("/tool"));
    EXPECT_EQ(s.set("/tool.rotation", Vec3(0, 0, 0.3)), "");
    s.step();
    const Quat half(Eigen::AngleAxisd(0.15, Vec3::UnitZ()));
    const auto half_way = [&] {
      const Pose pose = tool->half_way();
      return Vec3(pose.position + pose.rotation * (centre + arm));
    };
    EXPECT_LT((half_way() - (centre + half * arm)).norm(), 1e-12);
    // Turned back and moved along the axis: a screw.
    EXPECT_EQ(s.set("/tool.rotation", Vec3(0, 0, 0)), "");
    EXPECT_EQ(s.set("/tool.position", Vec3(centre + Vec3(0, 0, 0.01))), "");
    s.step();
    const Vec3 expected = centre + half * arm + Vec3(0, 0, 0.005);
    EXPECT_LT((half_way() - expected).norm(), 1e-12);
  }
}

TEST(Host, ATrackThatWasToldStaysThere) {
  const Running s(scene);
  auto* tool = dynamic_cast<Tool*>(s.simulation->find("/tool"));
  ASSERT_NE(tool, nullptr);
  const Pose there{Vec3(1e-3, 2e-3, 3e-3), Quat::Identity()};
  tool->move_to(there);
  s.step(3);
  EXPECT_EQ(tool->pose().position, there.position);
  EXPECT_LT((s.output<Vec3>("/jaws", "target") - Vec3(0.041, 2e-3, 3e-3)).norm(), rounding);
}

TEST(Host, JawsOpenAndCloseWhenTold) {
  const Running s(scene);
  auto* jaws = dynamic_cast<Jaws*>(s.simulation->find("/jaws"));
  s.step();
  EXPECT_TRUE(jaws->holding());  // by the schedule
  EXPECT_EQ(s.set("/jaws.hold", Real(0)), "");
  const Vec3 left = s.point(0);
  s.step(2);
  EXPECT_FALSE(jaws->holding());
  EXPECT_FALSE(s.rod().held());
  EXPECT_EQ(s.point(0), left);
  jaws->grasp();
  s.step();
  EXPECT_TRUE(s.rod().held());
  // Taken where it lies, then carried along one step of the tool: no jump to the old grip.
  EXPECT_LT((s.point(0) - left).norm(), 0.012);
  EXPECT_GT((s.point(0) - left).norm(), 0.001);
}

TEST(Host, ATimeOfReleaseCountsAgainAfterTheHost) {
  const Running s(
      "<Curve name='rod'/><Track name='tool' times='0'/>"
      "<Grasper name='jaws' grasp='0 s' release='0.5 s'/>");
  s.step();
  s.get<Grasper>("/jaws").release();
  s.step();
  s.get<Grasper>("/jaws").grasp();
  s.step();
  EXPECT_TRUE(s.get<Grasper>("/jaws").holding());
  s.step(3);  // the last one from 0.5 s on
  EXPECT_FALSE(s.get<Grasper>("/jaws").holding());
}

TEST(Host, WhatItHasSetIsPartOfTheState) {
  const Running s(scene), other(scene);
  s.step(3);
  EXPECT_EQ(s.set("/tool.position", Vec3(0.02, 0.05, 0)), "");
  EXPECT_EQ(s.set("/jaws.hold", Real(0)), "");
  const auto state = s.simulation->save();
  EXPECT_EQ(other.simulation->restore(state), "");
  for (int step = 0; step < 3; ++step) {
    s.step();
    other.step();
  }
  EXPECT_TRUE(s.simulation->save() == other.simulation->save());
  EXPECT_EQ(other.output<Real>("/jaws", "holding"), 0);
}

TEST(Host, WrongValuesAndNamesAreSentences) {
  const Running s(scene);
  EXPECT_EQ(s.set("/jaws.hold", Real(2)), "'hold' cannot be 2; expected 0 to 1");
  EXPECT_EQ(s.set("/jaws.hold", Vec3(1, 1, 1)), "'hold' takes one number");
  EXPECT_EQ(s.set("/tool.position", Real(1)), "'position' takes three numbers");
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  EXPECT_NE(s.set("/tool.position", Vec3(0, nan, 0)).find("a finite number"), std::string::npos);
  EXPECT_EQ(s.set("/tool.positon", Vec3::Zero()),
            "Track '/tool' has no input 'positon'; did you mean 'position'?; it has position, "
            "rotation");
  EXPECT_EQ(s.set("/rod.tip", Vec3::Zero()), "Curve '/rod' has no input 'tip'; it has none");
  EXPECT_NE(s.set("/tol.position", Vec3::Zero()).find("did you mean '/tool'?"), std::string::npos);
  EXPECT_NE(s.set("position", Vec3::Zero()).find("expected a component and its input"),
            std::string::npos);
}

}  // namespace
}  // namespace sutura::tools
