// A thread near the skin: beside the mouth of its channel, and where it begins a step too near.
#include <gtest/gtest.h>

#include "contact_memory.h"
#include "curve_surface.h"
#include "scenes/text_run.h"

namespace sutura::contact {
namespace {

using testing::TextRun;

/// Holds the first 5 mm of a thread.
class FirstPart : public Passage {
 public:
  FirstPart(const CurveBody& curve, const SolidBody& solid) : curve_(curve), solid_(solid) {}
  const CurveBody& curve() const override { return curve_; }
  const SolidBody& solid() const override { return solid_; }
  void inside(std::vector<Stretch>& out) const override { out.push_back({0, 5e-3}); }

 private:
  const CurveBody& curve_;
  const SolidBody& solid_;
};

constexpr Real mm = 1e-3, r = 0.1 * mm;

/// A thread of 0.2 mm along y over a block whose top is at 0, in beams of 1 mm.
struct OverSkin {
  OverSkin(Real height, bool is_held)
      : run(scene(height)),
        body(run.component<Body>("/a")),
        passage(run.component<CurveBody>("/a"), run.component<SolidBody>("/skin/tissue")),
        pair(run.component<SegmentedCurve>("/a"),
             std::make_shared<SolidBoundary>(run.component<MeshedSolid>("/skin/tissue")),
             is_held ? &passage : nullptr),
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
  FirstPart passage;
  CurveSurface pair;
  ContactMemory memory;
  std::vector<Touch> touches;
  Real start;
};

// What has come out of the channel and is not yet clear of the skin is left where it is, but for a
// twentieth of a radius, and may not sink in: not even where a guess has sunk in already.
TEST(BesideAMouth, AThreadDoesNotSinkIn) {
  OverSkin thread(0.6 * r, true);
  for (const Real height : {0.6 * r, 0.3 * r, -0.2 * r}) {
    thread.free_way(height);
    int nodes = 0;
    for (const Touch& t : thread.touches) {
      if (t.first_place > 8.5 * mm) continue;  // beyond the third beam
      EXPECT_GT(t.first_place, 5 * mm + 3 * r) << "the channel holds what is in its mouth";
      EXPECT_GT(t.normal.z(), 1 - 1e-9);
      EXPECT_NEAR(t.gap, height - r, 1e-9);
      EXPECT_NEAR(t.left, (1 - 0.05 - 0.6) * r, 1e-9);
      ++nodes;
    }
    EXPECT_EQ(nodes, 3) << height;
  }
}

// Barred from its first point on it would not get away, and with it nothing would. Said it is.
TEST(TooNear, MayGoWhereItComesNoNearer) {
  OverSkin thread(0.3 * r, false);
  EXPECT_EQ(thread.free_way(0.3 * r), 1);
  EXPECT_EQ(thread.free_way(2 * r), 1);
  EXPECT_EQ(thread.free_way(0.28 * r), 1);
  EXPECT_LT(thread.free_way(0.2 * r), 1);
  EXPECT_LT(thread.free_way(-r), 1);
  EXPECT_NEAR(thread.pair.unseen_overlap(), 0.7 * r, 1e-9);
}

}  // namespace
}  // namespace sutura::contact
