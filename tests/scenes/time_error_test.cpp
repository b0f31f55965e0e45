// What the length of a step costs: measured in every step, limited where a scene asks for it.
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

constexpr Real g = 9.81;

struct Falling {
  const char *content, *path, *where;
};
const Falling thread{
    "<SutureThread name=\"b\" needle_length=\"0\" thread_length=\"50 mm\" thread_beams=\"10\"/>",
    "/b", "end_position"};
const Falling tissue{
    "<BlockMesh box=\"0 0 0 10 10 10 mm\" cells=\"2 2 2\"/>"
    "<Tissue name=\"b\" young=\"20 kPa\"/>"
    "<TissueProbe name=\"p\" point=\"5 5 5 mm\"/>",
    "/p", "position"};

class TimeError : public ::testing::TestWithParam<Falling> {};

// A body that falls gets faster by g h in a step: implicit Euler puts it g h^2/2 too low.
TEST_P(TimeError, OfAFallIsThatOfImplicitEuler) {
  const Falling& f = GetParam();
  TextRun run(f.content, "dt=\"20 ms\" gravity=\"0 0 -9.81\"");
  ASSERT_TRUE(run) << run.said();
  const Real start = run.vector(f.path, f.where).z();
  Real sum = 0;
  for (int n = 1; n <= 10; ++n) {
    const StepReport& report = run.simulation().step();
    EXPECT_NEAR(report.worst_time_error(), g * 0.02 * 0.02 / 2, 1e-9);
    sum += report.worst_time_error();
    const Real exact = start - g * report.time * report.time / 2;
    EXPECT_NEAR(exact - run.vector(f.path, f.where).z(), sum, 1e-8);
  }
}

// Parts of h/n are n^2 times as accurate each, the step that they make n times: 1.96 mm whole, 0.98
// mm in halves, 0.49 mm in quarters.
TEST_P(TimeError, DividesAStepThatIsTooLong) {
  const Falling& f = GetParam();
  TextRun run(f.content, "dt=\"20 ms\" gravity=\"0 0 -9.81\" time_tolerance=\"0.5 mm\"");
  ASSERT_TRUE(run) << run.said();
  const StepReport& report = run.simulation().step();
  EXPECT_TRUE(report.solved);
  EXPECT_EQ(report.parts, 4);
  EXPECT_NEAR(report.worst_time_error(), g * 0.02 * 0.02 / 2 / 4, 1e-9);
}

TEST_P(TimeError, MayBeAnyWithoutATolerance) {
  TextRun run(GetParam().content, "dt=\"20 ms\" gravity=\"0 0 -9.81\" time_tolerance=\"0\"");
  ASSERT_TRUE(run) << run.said();
  EXPECT_EQ(run.simulation().step().parts, 1);
}

TEST_P(TimeError, ThatNoPartMeetsIsSaid) {
  const Falling& f = GetParam();
  TextRun run(f.content,
              "dt=\"20 ms\" gravity=\"0 0 -9.81\" time_tolerance=\"0.5 mm\" substeps=\"2\"");
  ASSERT_TRUE(run) << run.said();
  const StepReport& report = run.simulation().step();
  EXPECT_FALSE(report.solved);
  EXPECT_EQ(report.parts, 2);
}

INSTANTIATE_TEST_SUITE_P(Bodies, TimeError, ::testing::Values(thread, tissue),
                         [](const auto& i) { return i.index == 0 ? "thread" : "tissue"; });

// What moves evenly costs nothing, and what is held is where it is held.
TEST(TimeErrorOf, AHandThatMovesEvenlyIsThatOfItsFirstStep) {
  TextRun run(
      "<SutureThread name=\"b\" needle_length=\"0\" thread_length=\"50 mm\" "
      "thread_beams=\"10\" damping_mass=\"100 1/s\"/>"
      "<Track name=\"t\" times=\"0 1 s\" positions=\"0 0 0 100 0 0 mm\"/>"
      "<Grasper at=\"0\" track=\"t\"/>");
  ASSERT_TRUE(run) << run.said();
  // From rest to 0.1 m/s: h/2 of that, 0.5 mm; soon after it all moves as the hand does.
  EXPECT_NEAR(run.simulation().step().worst_time_error(), 0.5e-3, 0.05e-3);
  run.run(0.2);
  EXPECT_LT(run.simulation().step().worst_time_error(), 1e-6);
}

/// Steps in which a thread that falls from one hand, and is taken by another and drawn taut, says
/// that its tension is not known.
int doubts(const std::string& grasp) {
  TextRun run(
      "<SutureThread name='b' needle_length='0' tip='0 0 0' tip_direction='-1 0 0' "
      "thread_length='50 mm' thread_beams='40' bending_factor='0.05'/>"
      "<Track name='still' times='0' positions='0 0 0'/>"
      "<Track name='out' times='0.1 0.4 s' positions='0 0 0  5 0 0 mm'/>"
      "<Grasper name='one' track='still' at='0'/>"
      "<Grasper name='other' track='out' at='45 mm' grasp='" +
          grasp + "'/>",
      "dt='5 ms' gravity='0 0 -9.81'");
  EXPECT_TRUE(run) << run.said();
  int doubts = 0;
  while (run && run.simulation().time() < 0.4) {
    for (const std::string& note : run.simulation().step().messages)
      doubts += note.find("may be slack") != std::string::npos;
  }
  EXPECT_GT(run.number("/b", "largest_strain"), 1e-3) << "it is not taut";
  return doubts;
}

// It is drawn out by 0.08 mm a step, and was known to g h^2 / 2 = 0.12 mm as it was caught.
TEST(TimeErrorOf, AStrandThatWasCaughtIsTold) {
  EXPECT_GT(doubts("40 ms"), 0);
  EXPECT_EQ(doubts("0"), 0) << "it was at rest where it was taken";
}

}  // namespace
}  // namespace sutura::testing
