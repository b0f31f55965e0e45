// `time_order="2"`: threads are of second order in time in steps without rows.
#include <cmath>

#include "scenes/text_run.h"
#include "sutura/units.h"

namespace sutura::testing {
namespace {

const std::string contact = "<plugin name='contact'/>";
TextRun carried(Real dt, const char* order) {
  return TextRun::file("validation/carried_thread.xml",
                       {{".dt", format_real(dt) + " s"}, {".time_order", order}});
}

Vec3 end_of(const TextRun& run) {
  return run.vector("/suture", "end_position");
}

// A hand carries a thread by its end, and it swings on. Its first mode has 115 ms, and the steps
// resolve that: halving them takes three quarters of the error away, and not half of it. Modes that
// no step resolves are damped.
TEST(SecondOrder, ASwungThreadConvergesByTheSquareOfTheStep) {
  const auto end = [](Real dt, const char* order) {
    TextRun run = carried(dt, order);
    for (int n = 0; n < std::lround(0.6 / dt); ++n)
      EXPECT_TRUE(run.simulation().step().solved) << n;
    return end_of(run);
  };
  const Vec3 coarse = end(1e-3, "2"), middle = end(0.5e-3, "2"), fine = end(0.25e-3, "2");
  EXPECT_NEAR((coarse - middle).norm() / (middle - fine).norm(), 4, 0.5);
  // Richardson: the limit is a third of the last change further on. Implicit Euler is further from
  // it with half of the step.
  const Vec3 limit = fine + (fine - middle) / 3;
  EXPECT_GT((end(0.25e-3, "1") - limit).norm(), (middle - limit).norm());
}

// Where there are rows in every step, both orders are the same run to the bit.
TEST(SecondOrder, StepsWithRowsLookBackOneStep) {
  const std::string scene =
      contact +
      "<SutureThread name='t' needle_length='0' tip='5 0 0.1 mm' tip_direction='1 0 0' "
      "thread_length='40 mm' thread_diameter='0.2 mm' thread_beams='20'/>"
      "<Tool name='table' shape='plane' axis='0 0 1'/><Contact tool='table' friction='0.3'/>"
      "<Track name='hand' times='0 0.1 s' positions='0 0 0  10 20 0 mm'/>"
      "<Grasper at='0' track='hand'/>";
  TextRun one(scene, "dt='5 ms'"), two(scene, "dt='5 ms' time_order='2'");
  ASSERT_TRUE(one && two) << one.said() << two.said();
  for (int n = 0; n < 20; ++n) {
    ASSERT_GT(one.simulation().step().rows, 0);
    EXPECT_EQ(two.simulation().step().order, 1);
    EXPECT_EQ(one.vector("/t", "end_position"), two.vector("/t", "end_position")) << n;
  }
}

// A loop of thread falls on a bar: of second order until it is near, of first order from then on.
TEST(SecondOrder, EndsWhereTouchesBegin) {
  TextRun run(
      contact +
          "<SutureThread name='t' needle_length='0' tip='20 0 10 mm' tip_direction='1 0 0' "
          "thread_length='40 mm' thread_diameter='0.2 mm' thread_beams='20'/>"
          "<Tool name='bar' shape='cylinder' radius='2 mm' axis='0 1 0'/><Contact tool='bar'/>",
      "dt='5 ms' time_order='2'");
  ASSERT_TRUE(run) << run.said();
  Index last = 2;
  for (int n = 0; n < 20; ++n) {
    const StepReport& report = run.simulation().step();
    EXPECT_TRUE(report.solved) << n;
    EXPECT_EQ(report.order, report.rows > 0 ? 1 : 2) << n;
    last = report.order;
  }
  EXPECT_EQ(last, 1);
}

// What two steps back was is part of the state: a run that goes on from one is the same to the bit.
TEST(SecondOrder, GoesOnFromAStateToTheBit) {
  TextRun whole = carried(5e-3, "2"), halved = carried(5e-3, "2"), on = carried(5e-3, "2");
  for (int n = 0; n < 10; ++n) {
    whole.simulation().step();
    halved.simulation().step();
  }
  ASSERT_EQ(on.simulation().restore(halved.simulation().save()), "");
  for (int n = 0; n < 10; ++n) {
    whole.simulation().step();
    on.simulation().step();
    EXPECT_EQ(end_of(whole), end_of(on)) << n;
  }
}

TEST(SecondOrder, OfAnotherNumberIsAnError) {
  for (const char* order : {"0", "3", "1.5", "two"}) {
    TextRun run("<SutureThread thread_length='50 mm'/>", std::string("time_order='") + order + "'");
    EXPECT_FALSE(run) << order;
    EXPECT_NE(run.said().find("time_order"), std::string::npos) << run.said();
  }
}

}  // namespace
}  // namespace sutura::testing
