// The way of a thread round the corner of a box, guess by guess.
#include <gtest/gtest.h>

#include "contact_memory.h"
#include "curve_tool.h"
#include "scenes/text_run.h"

namespace sutura::contact {
namespace {

using testing::TextRun;

/// A thread of 0.2 mm along y, at x = 1 mm above a bar of 4 x 4 mm along y whose top is at 2 mm.
class RoundACorner : public ::testing::Test {
 protected:
  RoundACorner()
      : run_(
            "<plugin name='contact'/><SutureThread name='a' needle_length='0' "
            "thread_diameter='0.2 mm' thread_length='20 mm' thread_beams='20' tip='1 10 2.2 mm' "
            "tip_direction='0 1 0' plane_normal='1 0 0'/>"
            "<Tool name='bar' shape='box' size='4 200 4 mm' rounding='0.1 mm'/>"),
        body_(run_.component<Body>("/a")),
        pair_(run_.component<SegmentedCurve>("/a"), run_.component<RigidTool>("/bar")) {
    body_.load().setZero(body_.dofs());
    body_.begin_step(StepContext{});
    pair_.begin_step();
  }
  /// Of the guess that the thread is at this place, as a whole (mm).
  Real free_way(Real x, Real z) {
    VecX motion = VecX::Zero(body_.dofs());
    for (Index i = 0; i < body_.dofs(); i += 6)
      motion.segment<3>(i) = 1e-3 * Vec3(x - 1, 0, z - 2.2);
    body_.move_to(StepContext{}, motion);
    touches_.clear();
    pair_.find(memory_, touches_);
    return pair_.free_way();
  }
  void go_on(Real x, Real z) {
    EXPECT_EQ(free_way(x, z), 1);
    pair_.keep_guess();
  }

  TextRun run_;
  Body& body_;
  CurveTool pair_;
  ContactMemory memory_;
  std::vector<Touch> touches_;
};

// Straight it would lead through the bar. From a guess beside the corner it does not.
TEST_F(RoundACorner, GoesOnFromAGuessThatIsKept) {
  // Half a radius before the top is where it ends.
  EXPECT_NEAR(free_way(1.9, 1), (2.2 - 2.05) / (2.2 - 1), 0.01);
  EXPECT_LT(free_way(2.3, 1), 1);
  go_on(2.3, 2.3);
  go_on(2.3, 1);
  EXPECT_LT(free_way(1.9, 1), 1);  // from there neither: it is in the bar
  // What is kept is kept for a step.
  pair_.begin_step();
  EXPECT_LT(free_way(2.3, 1), 1);
}

// A thread that is at the opposite side may have come round an end of the bar, or of its own.
TEST_F(RoundACorner, IsNotGoneOnToTheOppositeSide) {
  go_on(2.3, 2.3);
  go_on(2.3, -1);
  EXPECT_LT(free_way(2.3, -2.3), 1);
  EXPECT_LT(free_way(1, -2.3), 1);
}

}  // namespace
}  // namespace sutura::contact
