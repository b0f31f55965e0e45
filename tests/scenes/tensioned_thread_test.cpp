// scenes/validation/tensioned_thread.xml: friction of a straight path while the thread slides, and
// the balance of a taut one.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "csv.h"
#include "house/command.h"
#include "text_run.h"

namespace sutura::testing {
namespace {

TEST(TensionedThread, DiffersInTensionByTheFrictionOfItsPath) {
  const house::TemporaryFolder folder("tensioned_thread");
  const house::Outcome outcome =
      house::command("run " SUTURA_SOURCE_DIR "/scenes/validation/tensioned_thread.xml --output " +
                     folder.path().string());
  ASSERT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_EQ(outcome.text.find("TOLERANCE MISSED"), std::string::npos) << outcome.text;
  const Table t = read_csv((folder.path() / "tension.csv").string());
  const double per_length =
      0.3 * 20e3 * std::numbers::pi * 0.175e-3;  // mu p pi d of the scene, N/m
  int slides = 0;
  for (std::size_t i = 0; i < t.rows.size(); ++i) {
    const double time = t.number(i, "time [s]"), samples = t.number(i, "path.samples");
    if (time < 0.85 || time > 1.35 || std::abs(t.number(i, "friction.sliding")) != samples)
      continue;
    const double law = per_length * t.number(i, "path.inserted_length [m]");
    EXPECT_NEAR(t.number(i, "friction.force [N]"), law, 0.02 * law)
        << "at " << time;  // as the stitch
    ++slides;
  }
  EXPECT_GE(slides, 30);
  // Taut: at the end nothing moves, so the hands and the path balance; 1 % of the friction is what
  // the swaying pad leaves.
  const std::size_t last = t.rows.size() - 1;
  const double below = -t.number(last, "tools/holder.force.z [N]"),
               above = t.number(last, "tools/tail.force.z [N]");
  EXPECT_GT(above, 0.5);
  EXPECT_NEAR(below - above, t.number(last, "friction.force [N]"), 0.01 * per_length * 10e-3);
  EXPECT_LE(std::abs(below - above), 1.02 * per_length * 10e-3);
  EXPECT_EQ(t.number(last, "puncture.punctures"), 2);
  EXPECT_EQ(t.number(last, "puncture.overruns"), 0);
}

/// The same thread pulled aside and held at 1.6 N, so that its
/// bends at the mouths are sharper than its beams.
class HeldThread : public ::testing::TestWithParam<double> {};

TEST_P(HeldThread, NeitherCreepsNorTrembles) {
  const std::string dt = std::to_string(GetParam()) + " ms";
  TextRun run = TextRun::file(
      "validation/tensioned_thread.xml",
      {{".dt", dt}, {"/tools/tail_track.positions", "0 0 0  0 0 -60  0 0 -60  10 0 -57.5 mm"}});
  ASSERT_TRUE(run);
  run.run(3.5);
  const Real in_path = run.number("/path", "entry_abscissa");
  EXPECT_GT(std::abs(run.vector("/tools/tail", "force").norm()), 1.5);
  for (int k = 0; k < 10; ++k) {
    run.run(3.5 + 0.2 * k);
    EXPECT_TRUE(run.simulation().report().solved);
    // A nanometre in two seconds: what friction holds may not creep, whatever a step leaves.
    EXPECT_NEAR(run.number("/path", "entry_abscissa"), in_path, 1e-9);
  }
  EXPECT_LT(run.number("/suture", "kinetic_energy"), 1e-18);
}

INSTANTIATE_TEST_SUITE_P(Steps, HeldThread, ::testing::Values(5, 10, 20));

}  // namespace
}  // namespace sutura::testing
