// The way of a thread round the corner of a box, guess by guess.
#include <gtest/gtest.h>

#include "contact_memory.h"
#include "curve_tool.h"
#include "scenes/text_run.h"

namespace sutura::contact {
namespace {

using testing::TextRun;

/// A thread of 0.2 mm along y, at x = 1 mm above a bar of 4 x 4 mm along y whose top is at 2 mm.
struct AboveABar {
  explicit AboveABar(Real height)  // mm
      : run(scene(height)),
        body(run.component<Body>("/a")),
        pair(run.component<SegmentedCurve>("/a"), run.component<RigidTool>("/bar")),
        start(1, 0, height) {
    body.load().setZero(body.dofs());
    body.begin_step(StepContext{});
    pair.begin_step();
  }
  static std::string scene(Real height) {
    return "<plugin name='contact'/><SutureThread name='a' needle_length='0' "
           "thread_diameter='0.2 mm' thread_length='20 mm' thread_beams='20' tip='1 10 " +
           std::to_string(height) +
           " mm' tip_direction='0 1 0' plane_normal='1 0 0'/>"
           "<Tool name='bar' shape='box' size='4 200 4 mm' rounding='0.1 mm'/>";
  }
  /// Of the guess that the thread as a whole is at this place (mm).
  Real free_way(Real x, Real z) {
    VecX motion = VecX::Zero(body.dofs());
    for (Index i = 0; i < body.dofs(); i += 6)
      motion.segment<3>(i) = 1e-3 * (Vec3(x, 0, z) - start);
    body.move_to(StepContext{}, motion);
    touches.clear();
    pair.find(memory, touches);
    return pair.free_way();
  }
  void go_on(Real x, Real z) {
    EXPECT_EQ(free_way(x, z), 1);
    pair.keep_guess();
  }

  TextRun run;
  Body& body;
  CurveTool pair;
  ContactMemory memory;
  std::vector<Touch> touches;
  Vec3 start;  // mm
};

constexpr Real on_it = 2.15;  // mm: near enough for a touch

// Straight it would lead through the bar. From a guess beside the corner it does not.
TEST(RoundACorner, GoesOnFromAGuessThatIsKept) {
  AboveABar thread(on_it);
  // Half a radius before the top is where it ends.
  EXPECT_NEAR(thread.free_way(1.9, 1), (2.15 - 2.05) / (2.15 - 1), 0.01);
  EXPECT_LT(thread.free_way(2.3, 1), 1);
  thread.go_on(2.3, 2.3);
  thread.go_on(2.3, 1);
  EXPECT_LT(thread.free_way(1.9, 1), 1);  // from there neither: it is in the bar
  // What is kept is kept for a step.
  thread.pair.begin_step();
  EXPECT_LT(thread.free_way(2.3, 1), 1);
}

// A thread that is at the opposite side may have come round an end of the bar, or of its own.
TEST(RoundACorner, IsNotGoneOnToTheOppositeSide) {
  AboveABar thread(on_it);
  thread.go_on(2.3, 2.3);
  thread.go_on(2.3, -1);
  EXPECT_LT(thread.free_way(2.3, -2.3), 1);
  EXPECT_LT(thread.free_way(1, -2.3), 1);
}

// What comes flying does not slide round: it hits the top.
TEST(RoundACorner, IsGoneRoundByWhatLiesOnTheToolAlone) {
  AboveABar thread(3);
  thread.go_on(2.3, 2.3);
  EXPECT_LT(thread.free_way(2.3, 1), 1);
}

}  // namespace
}  // namespace sutura::contact
