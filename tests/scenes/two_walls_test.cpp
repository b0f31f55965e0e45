// A needle through two walls of one tissue, one behind the other: what it goes through in one step,
// and what it may pass, is more than the wall that it presses on.
#include <ostream>
#include <string>
#include <vector>

#include "text_run.h"

namespace sutura::testing {
namespace {

/// Two plates in one mesh, 10 x 10 mm, held at their sides, and a straight needle that is pushed
/// through their middle at a constant speed until its tip is 8 mm below the top of the upper one.
struct Plates {
  const char *depth, *cells, *gap, *threshold;
  bool touch;  ///< by Contact
  Real speed;  ///< of the needle (m/s)
  Real thick;  ///< both together (m)
  const char* dt;
  friend void PrintTo(const Plates& p, std::ostream* out) { *out << p.gap << ", " << p.dt; }
};

std::string text(const Plates& p) {
  const std::string at = std::to_string(9e-3 / p.speed);  // from 1 mm above it to 8 mm below
  return std::string("<plugin name='contact'/><BlockMesh box='-5 -5 -") + p.depth +
         "  5 5 0 mm' cells='" + p.cells + "' holes='-6 -6 " + p.gap +
         " mm'/><Tissue name='tissue' young='100 kPa' poisson='0.4' damping_stiffness='1 ms'/>"
         "<Attach name='a' box='-5 -5 -9  -5 5 0 mm'/><Attach name='b' box='5 -5 -9  5 5 0 mm'/>"
         "<SutureThread name='suture' needle_length='20 mm' needle_angle='0' "
         "needle_diameter='0.5 mm' tip='0.11 0.07 1 mm' tip_direction='0 0 -1' "
         "plane_normal='0 1 0' thread_length='20 mm' thread_beams='10'/>" +
         (p.touch ? "<Contact friction='0.2' first='/tissue'/>" : "") + "<Track times='0 " + at +
         " s' positions='0 0 0  0 0 -9 mm'/><Grasper at='18 mm'/>"
         "<SuturePath name='path' spacing='0.5 mm'/><Puncture name='puncture' threshold='" +
         p.threshold +
         "'/><Cutting threshold='0.01 N'/><PathFriction coefficient='0.2' pressure='5 kPa'/>";
}

class TwoWalls : public ::testing::TestWithParam<Plates> {};

// The upper plate is pressed onto the lower one, or the needle is so fast that it is through both
// in two steps. Where the tip comes out of the upper one, the lower one springs back over it, by 2
// mm in a step. Before, nothing held that: two punctures, half of the length inside, and no word.
TEST_P(TwoWalls, ArePuncturedOnceFromEachSide) {
  const Plates& p = GetParam();
  TextRun run(text(p), std::string("dt='") + p.dt + "' gravity='0 0 0'");
  ASSERT_TRUE(run) << run.said();
  const Real end = 9e-3 / p.speed + 0.05;  // s; the plates are at rest again
  while (run.simulation().time() < end - 1e-9) {
    const StepReport& report = run.simulation().step();
    ASSERT_TRUE(report.solved) << report.time;
    ASSERT_TRUE(report.faults.empty()) << report.time << report.faults.front();
  }
  EXPECT_EQ(run.number("/puncture", "punctures"), 4);
  EXPECT_EQ(run.number("/puncture", "overruns"), 0);
  // What rubs along the needle bends the plates by a hundredth of what they are thick.
  EXPECT_NEAR(run.number("/path", "inserted_length"), p.thick, 0.02 * p.thick);
  // Each bite has its samples, whether it was made in one step or in many: a mouth at either end,
  // and between them one each half millimetre, but none within a quarter of the exit (as the
  // needle may be pressed together by a little, one more or less a plate).
  const Real inner = 0.5 * p.thick / 0.5e-3 - 1;
  EXPECT_NEAR(run.number("/path", "samples"), 4 + 2 * inner, 2);
}

// Two plates of 1 mm and 1 mm apart, two of 0.5 mm and 2 mm apart, both pressed together by a slow
// needle; two of 2 mm and 1 mm apart at 100 mm/s, by which a needle moves 4 mm in a step.
std::vector<Plates> plates() {
  std::vector<Plates> all;
  for (const char* dt : {"20 ms", "10 ms", "5 ms"})
    all.push_back({"3", "9 9 3", "-1.9 6 6 -1.1", "0.2 N", true, 0.02, 2e-3, dt});
  for (const char* dt : {"5 ms", "2 ms"})
    all.push_back({"3", "9 9 6", "-2.4 6 6 -0.6", "0.1 N", true, 0.02, 1e-3, dt});
  for (const char* dt : {"40 ms", "25 ms"})
    all.push_back({"5", "7 7 5", "-2.9 6 6 -2.1", "0.1 N", false, 0.1, 4e-3, dt});
  return all;
}
INSTANTIATE_TEST_SUITE_P(Steps, TwoWalls, ::testing::ValuesIn(plates()));

// Without a Contact the upper plate is pressed into the lower one, and the tip with it. It comes
// out of the upper one below the lower one, and nothing can make up for that. Before, the tissue
// that was counted as on the needle went from the top of the one to the underside of the other: 3
// mm, with exit code 0.
TEST(Walls, AWallThatIsPassedIsAFault) {
  TextRun run(text({"3", "9 9 6", "-2.4 6 6 -0.6", "0.1 N", false, 0.02, 1e-3, "5 ms"}),
              "dt='5 ms' gravity='0 0 0'");
  ASSERT_TRUE(run) << run.said();
  std::string said;
  while (run.simulation().time() < 0.5 - 1e-9)
    for (const std::string& fault : run.simulation().step().faults) said += fault;
  EXPECT_NE(said.find("got through a wall without a puncture"), std::string::npos) << said;
  EXPECT_EQ(run.number("/puncture", "overruns"), 1);
}

}  // namespace
}  // namespace sutura::testing
