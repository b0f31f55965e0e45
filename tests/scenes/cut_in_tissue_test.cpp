// A sewn thread that is cut: its path holds what is left on each side of the cut, and nothing
// across it. An end that is drawn through the channel comes out, and what is cut off stays where it
// is.
#include <numbers>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

constexpr Real mm = 1e-3;
constexpr Real thickness = 4e-3;                               // of the slab
constexpr Real speed = 40e-3 / 0.7;                            // of the hand, from 0.2 s on (m/s)
constexpr Real rubs = 0.3 * 10e3 * std::numbers::pi * 0.2e-3;  // mu p pi d (N/m)

/// A slab from z = -4 mm to 0, held at two sides, and a straight thread that is sewn through it:
/// its tip at z = -14 mm, its end at 26 mm.
std::string slab_and_thread(const std::string& beams) {
  return "<BlockMesh box='-5 -5 -4  5 5 0 mm' cells='7 7 4'/><Tissue name='t' young='60 kPa' "
         "poisson='0.4' damping_stiffness='2 ms'/><Attach name='a' box='-5 -5 -4  -5 5 0 mm'/>"
         "<Attach name='b' box='5 -5 -4  5 5 0 mm'/><SutureThread name='w' needle_length='0' "
         "tip='0.11 0.07 -14 mm' tip_direction='0 0 -1' plane_normal='0 1 0' thread_length='40 mm' "
         "thread_beams='" +
         beams +
         "' thread_diameter='0.2 mm' damping_mass='20 1/s'/><SuturePath name='path' spacing='0.5 "
         "mm' sewn='true'/><PathFriction name='friction' coefficient='0.3' pressure='10 kPa'/>";
}

/// Blades that close at 0.1 s at a height.
std::string cut_at(const std::string& z) {
  return "<Track name='still' times='0 s' positions='0 0 0 mm'/><Scissors track='still' "
         "centre='0.11 0.07 " +
         z + " mm' axis='1 0 0' size='2 2 0.2 mm' times='0.1 s'/>";
}

/// A hand at abscissa `at` that draws by 40 mm between 0.2 and 0.9 s.
std::string drawn(const std::string& at, const std::string& way) {
  return "<Track name='pull' times='0.2 0.9 s' positions='0 0 0  0 0 " + way +
         " mm'/><Grasper name='hand' track='pull' at='" + at + " mm'/>";
}

struct Outside {
  const char *height, *hand, *way;  ///< where it is cut, held, and drawn to (mm)
  const char* stays;                ///< the output that is the far end of what is cut off
  Real sign;                        ///< of the way
};

class CutOutside : public ::testing::TestWithParam<std::tuple<Outside, const char*>> {};

TEST_P(CutOutside, TheEndOfWhatIsDrawnGoesThroughAndTheRestStays) {
  const auto& [where, dt] = GetParam();
  TextRun run(slab_and_thread("40") + cut_at(where.height) + drawn(where.hand, where.way),
              "gravity='0 0 0' dt='" + std::string(dt) + "'");
  ASSERT_TRUE(run) << run.said();
  const Vec3 before = run.vector("/w", where.stays);
  Simulation& simulation = run.simulation();
  Real last = thickness;
  while (simulation.time() < 0.36) {
    const StepReport& report = simulation.step();
    ASSERT_TRUE(report.solved) << report.step;
    ASSERT_TRUE(report.faults.empty()) << report.faults.front();
    // Beams of 1 mm have nodes at whole millimetres: what is left begins 2 mm outside of the slab.
    const Real gone = speed * std::max(report.time - 0.2, 0.) - 2 * mm;
    const Real inside = std::clamp(thickness - gone, 0., thickness);
    // What is dragged of the slab round the channel goes along, by 0.043 mm at the full 0.0075 N.
    const Real length = run.number("/path", "inserted_length");
    EXPECT_NEAR(length, inside, 0.05 * mm) << report.time;
    // The friction of a step is that of the length at its start. While the hand starts, the thread
    // stretches and the slab gives way.
    if (report.time > 0.22) {
      const Real pull = where.sign * run.vector("/hand", "force").z();
      EXPECT_NEAR(pull, rubs * last, 0.01 * rubs * thickness) << report.time;
    }
    last = length;
  }
  EXPECT_EQ(run.number("/w", "cuts"), 1);
  EXPECT_EQ(run.number("/path", "samples"), 0);
  EXPECT_EQ(std::get<std::string>(run.output("/path", "state")), "outside");
  // Nothing acts on it. As it was cut, it was strained by the residual of a thread at rest only.
  EXPECT_LT((run.vector("/w", where.stays) - before).norm(), 1e-8);
}

INSTANTIATE_TEST_SUITE_P(
    Sides, CutOutside,
    ::testing::Combine(::testing::Values(Outside{"2.4", "2", "-40", "end_position", -1},
                                         Outside{"-6.4", "37", "40", "tip_position", 1}),
                       ::testing::Values("1 ms", "5 ms", "20 ms")));

TEST(CutInTissue, BothPiecesStayInTheChannelEachWithItsFriction) {
  // Beams of half a millimetre, one of which is cut, from z = -1.5 to -1 mm.
  TextRun run(slab_and_thread("80") + cut_at("-1.2") + drawn("2", "-40") +
                  "<Grasper name='other' track='still' at='37 mm'/>",
              "gravity='0 0 0' dt='5 ms'");
  ASSERT_TRUE(run) << run.said();
  run.run(0.19);
  EXPECT_EQ(run.number("/w", "cuts"), 1);
  // The slab lies still: what is missing is the beam.
  EXPECT_NEAR(run.number("/path", "inserted_length"), thickness - 0.5 * mm, 1e-3 * mm);
  EXPECT_NEAR(run.number("/friction", "limit"), rubs * (thickness - 0.5 * mm), 1e-3 * rubs * mm);
  // The lower piece begins with 2.5 mm in the slab, and is out after 44 ms.
  run.run(0.22);
  EXPECT_NEAR(run.number("/path", "inserted_length"), 3.5 * mm - 0.02 * speed, 0.02 * mm);
  run.run(0.3);
  EXPECT_NEAR(run.number("/path", "inserted_length"), 1 * mm, 0.02 * mm);
  // Nothing draws at the hand; on the piece that stays, the slab does, as far as it was dragged.
  EXPECT_LT(run.vector("/hand", "force").norm(), 1e-3 * rubs * thickness);
  EXPECT_LT(run.vector("/other", "force").norm(), 1.01 * rubs * mm);
  EXPECT_TRUE(run.simulation().report().solved);
}

TEST(CutInTissue, BetweenTwoBitesEachPieceKeepsItsOwn) {
  // Through both lips of a wound, 20 mm with a slit of 0.2 mm at x = 0, and cut there: beams of 1
  // mm from x = -15 mm on, so the one from 0 to 1 mm, or from -1 to 0.
  TextRun run(
      "<node name='skin'><TetMesh file='../meshes/strip.msh' unit='mm'/><Tissue young='50 kPa' "
      "damping_stiffness='2 ms'/><Attach box='-10 -9 -5  10 9 -5 mm'/></node><SutureThread "
      "name='w' needle_length='0' tip='15 0.3 -2.2 mm' tip_direction='1 0 0' plane_normal='0 1 0' "
      "thread_length='30 mm' thread_beams='30' thread_diameter='0.2 mm' damping_mass='20 1/s'/>"
      "<SuturePath name='path' sewn='true'/><PathFriction name='friction' coefficient='0.3' "
      "pressure='10 kPa'/><Track name='still' times='0 s' positions='0 0 0 mm'/><Scissors "
      "track='still' centre='0 0.3 -2.2 mm' size='0.1 2 2 mm' times='0.1 s'/><Track name='pull' "
      "times='0.2 0.6 s' positions='0 0 0  20 0 0 mm'/><Grasper name='hand' track='pull' at='2 "
      "mm'/>",
      "gravity='0 0 0' dt='5 ms'");
  ASSERT_TRUE(run) << run.said();
  const Vec3 before = run.vector("/w", "end_position");
  Real last = 1;
  while (run.simulation().time() < 0.55) {
    const StepReport& report = run.simulation().step();
    ASSERT_TRUE(report.solved && report.faults.empty()) << report.step;
    const Real length = run.number("/path", "inserted_length");
    EXPECT_LT(length, last + 0.02 * mm) << report.time;
    last = length;
  }
  EXPECT_EQ(run.number("/w", "cuts"), 1);
  // The bite of the other lip is 9.9 mm long, less what was cut of it, 0.9 mm or nothing.
  EXPECT_GT(last, 8.98 * mm);
  EXPECT_LT(last, 9.92 * mm);
  EXPECT_LT(run.vector("/hand", "force").norm(), 1e-3 * rubs * 10 * mm);
  // It is strained no more than by what the slit has let go of.
  EXPECT_LT((run.vector("/w", "end_position") - before).norm(), 1e-6);
}

TEST(CutInTissue, ARunGoesOnFromAStateBitByBit) {
  TextRun run(slab_and_thread("40") + cut_at("2.4") + drawn("2", "-40"),
              "gravity='0 0 0' dt='5 ms'");
  ASSERT_TRUE(run) << run.said();
  run.run(0.265);  // the end is 1.7 mm in the slab
  Simulation& simulation = run.simulation();
  const std::vector<std::byte> state = simulation.save();
  run.run(0.3);
  const std::vector<std::byte> then = simulation.save();
  TextRun other(slab_and_thread("40") + cut_at("2.4") + drawn("2", "-40"),
                "gravity='0 0 0' dt='5 ms'");
  ASSERT_EQ(other.simulation().restore(state), "");
  EXPECT_NEAR(other.number("/path", "inserted_length"), 2.3 * mm, 0.1 * mm);
  other.run(0.3);
  EXPECT_EQ(other.simulation().save(), then);
}

// An end that comes out of its mouth by less than its radius still lies in the surface. The path
// let go of it there, and a contact found it gone through: in step 352 at 1 ms, in 118 at 3 ms.
TEST(CutInTissue, AnEndComesOutOfItsMouthIntoContact) {
  for (const char* dt : {"1 ms", "3 ms"}) {
    TextRun run("<plugin name='contact'/><Contact first='w' second='t' friction='0.1'/>" +
                    slab_and_thread("40") + cut_at("-6.4") + drawn("37", "28"),
                "gravity='0 0 0' dt='" + std::string(dt) + "'");
    ASSERT_TRUE(run) << run.said();
    while (run.simulation().time() < 0.38) {
      const StepReport& report = run.simulation().step();
      ASSERT_TRUE(report.solved && report.faults.empty()) << dt << ", step " << report.step;
    }
    EXPECT_EQ(run.number("/path", "samples"), 0);
  }
}

}  // namespace
}  // namespace sutura::testing
