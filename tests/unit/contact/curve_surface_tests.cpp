// A thread that begins a step nearer to the skin than it may come.
#include <gtest/gtest.h>

#include "contact_memory.h"
#include "curve_surface.h"
#include "scenes/text_run.h"

namespace sutura::contact {
namespace {

using testing::TextRun;

constexpr Real mm = 1e-3, r = 0.1 * mm;

/// A thread of 0.2 mm along y over a block whose top is at 0, in beams of 1 mm.
struct OverSkin {
  explicit OverSkin(Real height)
      : run(scene(height)),
        body(run.component<Body>("/a")),
        pair(run.component<SegmentedCurve>("/a"),
             std::make_shared<SolidBoundary>(run.component<MeshedSolid>("/skin/tissue")), nullptr),
        start(height) {
    for (Body* b : {&body, &run.component<Body>("/skin/tissue")}) {
      b->load().setZero(b->dofs());
      b->begin_step(StepContext{});
    }
    pair.begin_step();
  }
  static std::string scene(Real height) {
    return "<plugin name='contact'/><node name='skin'>"
           "<BlockMesh box='-12 -12 -4 12 12 0 mm' cells='6 6 2'/>"
           "<Tissue name='tissue' young='20 kPa' poisson='0.3'/></node>"
           "<SutureThread name='a' needle_length='0' thread_diameter='0.2 mm' "
           "thread_length='20 mm' thread_beams='20' tip='1 10 " +
           std::to_string(height / mm) + " mm' tip_direction='0 1 0' plane_normal='1 0 0'/>";
  }
  /// Of the guess that the thread as a whole is at this height.
  Real free_way(Real height) {
    VecX motion = VecX::Zero(body.dofs());
    for (Index i = 0; i < body.dofs(); i += 6) motion[i + 2] = height - start;
    body.move_to(StepContext{}, motion);
    touches.clear();
    pair.find(memory, touches);
    return pair.free_way();
  }

  TextRun run;
  Body& body;
  CurveSurface pair;
  ContactMemory memory;
  std::vector<Touch> touches;
  Real start;
};

// Barred from its first point on it would not get away, and with it nothing would. Said it is.
TEST(TooNear, MayGoWhereItComesNoNearer) {
  OverSkin thread(0.3 * r);
  EXPECT_EQ(thread.free_way(0.3 * r), 1);
  EXPECT_EQ(thread.free_way(2 * r), 1);
  EXPECT_EQ(thread.free_way(0.28 * r), 1);
  EXPECT_LT(thread.free_way(0.2 * r), 1);
  EXPECT_LT(thread.free_way(-r), 1);
  EXPECT_NEAR(thread.pair.unseen_overlap(), 0.7 * r, 1e-9);
}

}  // namespace
}  // namespace sutura::contact
