// A host leads a tool and works its jaws: the section goes where the host says, step by step.
#include <gtest/gtest.h>

#include "grasper.h"
#include "track.h"
#include "unit/tools/fake_curve.h"

namespace sutura::tools {
namespace {

constexpr Real rounding = 1e-14;  // m, of a few dozen sums of millimetres

class Host : public testing::Test {
 protected:
  Host() {
    registry_.component<Track>("Track");
    registry_.component<Grasper>("Grasper");
    registry_.component<fake::Curve>("Curve");
    auto scene = load_scene_text(
        "<sutura version='1' dt='0.1 s'><Grasper name='jaws' at='30 mm'/>"
        "<Curve name='rod' length='100 mm'/>"
        "<Track name='tool' times='0 1 s' positions='0 0 0  0 0 10 mm'/></sutura>",
        "test.xml", ".", registry_, diagnostics_);
    simulation_ = Simulation::compile(std::move(scene), ".", diagnostics_);
    tool_ = dynamic_cast<Tool*>(simulation_->find("/tool"));
    jaws_ = dynamic_cast<Jaws*>(simulation_->find("/jaws"));
    rod_ = dynamic_cast<fake::Curve*>(simulation_->find("/rod"));
  }
  Vec3 section() const { return rod_->point(30e-3, Configuration::current); }
  static Pose moved(const Vec3& by) { return {by, Quat::Identity()}; }

  Registry registry_;
  Diagnostics diagnostics_;
  std::unique_ptr<Simulation> simulation_;
  Tool* tool_ = nullptr;
  Jaws* jaws_ = nullptr;
  fake::Curve* rod_ = nullptr;
};

TEST_F(Host, LeadsTheSectionInPlaceOfTheKeyFrames) {
  const Vec3 start = section();
  simulation_->step();  // by key frames: a tenth of 10 mm
  EXPECT_LT((section() - start - Vec3(0, 0, 1e-3)).norm(), rounding);
  tool_->lead(moved({5e-3, 0, 1e-3}));
  simulation_->step();
  EXPECT_LT((section() - start - Vec3(5e-3, 0, 1e-3)).norm(), rounding);
  simulation_->step();  // not led on: it stays
  EXPECT_LT((section() - start - Vec3(5e-3, 0, 1e-3)).norm(), rounding);
  tool_->lead(moved({9e-3, 9e-3, 9e-3}));
  tool_->lead(moved({0, 0, 0}));  // the last word before the step holds
  simulation_->step();
  EXPECT_LT((section() - start).norm(), rounding);
}

TEST_F(Host, OpensAndClosesTheJaws) {
  const Vec3 start = section();
  jaws_->open();
  simulation_->step();
  EXPECT_FALSE(jaws_->closed());
  EXPECT_LT((section() - start).norm(), rounding) << "the tool moved without it";
  jaws_->close();
  tool_->lead(moved({0, 0, 1e-3}));  // where the key frames have brought it: nothing to follow
  simulation_->step();
  EXPECT_TRUE(jaws_->closed());
  EXPECT_LT((section() - start).norm(), rounding) << "what is gripped does not jump";
  tool_->lead(moved({0, 2e-3, 1e-3}));
  simulation_->step();
  EXPECT_LT((section() - start - Vec3(0, 2e-3, 0)).norm(), rounding);
}

}  // namespace
}  // namespace sutura::tools
