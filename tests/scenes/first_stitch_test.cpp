// The physics of scenes/suture/first_stitch.xml, read from its CSV as a user would. The command
// runs the scene; the numbers it is held against are the attributes of the scene and the tables of
// reference/ (d01, d02).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "csv.h"
#include "house/command.h"

namespace sutura::testing {
namespace {

using house::TemporaryFolder;

constexpr double fp = 0.3, fc = 0.1;     // N, from the scene
constexpr double friction = 0.3 * 20e3;  // mu p, Pa
constexpr double needle_length = 26e-3;  // m
constexpr double needle_diameter = 0.65e-3, thread_diameter = 0.175e-3;
constexpr double pad_mass = 50e-3 * 30e-3 * 10e-3 * 1000;               // kg
constexpr double suture_mass = 68.15803072e-6 + 0.15 * 21.88806507e-6;  // kg, d02 and d01

struct StitchRun {
  double dt = 0;
  Table table;
  std::size_t size() const { return table.rows.size(); }
  double at(std::size_t row, const std::string& column) const { return table.number(row, column); }
  std::array<double, 3> vector(std::size_t row, const std::string& name,
                               const std::string& unit) const {
    return {at(row, name + ".x [" + unit + "]"), at(row, name + ".y [" + unit + "]"),
            at(row, name + ".z [" + unit + "]")};
  }
  double norm(std::size_t row, const std::string& name, const std::string& unit) const {
    const auto v = vector(row, name, unit);
    return std::hypot(v[0], v[1], v[2]);
  }
};

StitchRun run_stitch(double dt) {
  const TemporaryFolder folder("first_stitch_" + std::to_string(std::lround(dt * 1e6)));
  const house::Outcome outcome = house::command(
      "run " SUTURA_SOURCE_DIR "/scenes/suture/first_stitch.xml --set .dt=" + std::to_string(dt) +
      " --set /vtu_recorder.interval=1 --output " + folder.path().string());
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_EQ(outcome.text.find("TOLERANCE MISSED"), std::string::npos) << outcome.text;
  StitchRun run{dt, read_csv((folder.path() / "stitch.csv").string())};
  EXPECT_EQ(run.size(), std::size_t(std::lround(5 / dt)) + 1);
  return run;
}

/// pi mu p times the diameter, integrated over what is inside: the closed form of the law.
double law(const StitchRun& r, std::size_t i) {
  const double high = r.at(i, "path.entry_abscissa [m]");
  const double low = high - r.at(i, "path.inserted_length [m]");
  const double on_needle = std::max(std::min(high, needle_length) - std::max(low, 0.), 0.);
  const double on_thread = high - std::max(low, 0.) - on_needle;
  return std::numbers::pi * friction * (needle_diameter * on_needle + thread_diameter * on_thread);
}

void expect_puncture(const StitchRun& r) {
  double highest = 0;
  std::size_t entry = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    highest = std::max(highest, r.at(i, "puncture.force [N]"));
    if (entry == 0 && r.at(i, "puncture.punctures") > 0) entry = i;
  }
  ASSERT_GT(entry, 0u) << "no puncture";
  // Rises to fp and not above; the event itself is recorded as the peak.
  EXPECT_LE(highest, fp * (1 + 1e-9));
  // A step of 20 ms drives the needle by a fifth of the indentation: the last record before the
  // event is that far below fp.
  EXPECT_GT(r.at(entry - 1, "puncture.force [N]"), 0.45 * fp);
  EXPECT_NEAR(r.at(entry, "puncture.peak_force [N]"), fp, 0.01 * fp);
  // Drops to the cutting force and the friction on what slipped in.
  EXPECT_LT(r.at(entry, "puncture.force [N]"), 0.6 * fp);
  EXPECT_LE(r.at(entry + 2, "cutting.force [N]"), fc * (1 + 1e-9));
  EXPECT_EQ(r.at(r.size() - 1, "puncture.punctures"), 2) << "one entry and one exit";
  EXPECT_EQ(r.table.text(r.size() - 1, "path.state"), "outside");
}

void expect_friction(const StitchRun& r) {
  std::size_t slides = 0, sticks = 0;
  for (std::size_t i = 1; i < r.size(); ++i) {
    const double samples = r.at(i, "path.samples");
    // Lengths are those at the start of the step that the force belongs to.
    if (r.at(i - 1, "path.samples") < 1 || samples < 1) continue;
    const double force = std::abs(r.at(i, "friction.force [N]")), limit = law(r, i - 1);
    if (std::abs(r.at(i, "friction.sliding")) == r.at(i - 1, "path.samples")) {
      // 2 %, as the issue asks: half a sample at the swage is what a sample may misjudge.
      EXPECT_NEAR(force, limit, 0.02 * limit + 1e-6) << "at row " << i;
      ++slides;
    } else {
      EXPECT_LE(force, limit * 1.02 + 1e-6) << "at row " << i;
      ++sticks;
    }
  }
  EXPECT_GT(slides, r.size() / 3);
  EXPECT_GT(sticks, 0u);
}

void expect_path_holds(const StitchRun& r) {
  for (std::size_t i = 0; i < r.size(); ++i) {
    EXPECT_LT(r.at(i, "path.lateral_gap [m]"), 0.1e-3) << "at row " << i;
  }
  // The thread slides through: at the end more than 60 mm of it (and the needle) have passed the
  // entry.
  EXPECT_GT(r.at(r.size() - 1, "path.entry_abscissa [m]"), needle_length + 60e-3);
}

void expect_tissue_returns(const StitchRun& r) {
  double largest = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    largest = std::max(largest, r.at(i, "skin/tissue.max_displacement [m]"));
  }
  EXPECT_GT(largest, 1e-3);
  // What is left is the pull of the thread, 0.03 N of friction against 0.3 N of puncture.
  EXPECT_LT(r.at(r.size() - 1, "skin/tissue.max_displacement [m]"), 0.15 * largest);
}

/// Rate of momentum = weight + tools + bed, in every step.
void expect_momentum_balance(const StitchRun& r) {
  for (std::size_t i = 1; i < r.size(); ++i) {
    std::array<double, 3> rest{};
    double applied = 0;
    for (int k = 0; k < 3; ++k) {
      rest[k] = -9.81 * (pad_mass + suture_mass) * (k == 2);
      for (const char* body : {"suture.momentum", "skin/tissue.momentum"}) {
        rest[k] -= (r.vector(i, body, "kg m/s")[k] - r.vector(i - 1, body, "kg m/s")[k]) / r.dt;
      }
    }
    for (const char* force :
         {"tools/holder.force", "tools/puller.force", "tools/tail.force", "skin/tissue.reaction"}) {
      const auto f = r.vector(i, force, "N");
      for (int k = 0; k < 3; ++k) rest[k] += f[k];
      applied += r.norm(i, force, "N");
    }
    // Asked: 1 % of the applied forces, which is also what the scene's tolerance leaves of balance
    // at a node of the thread. (2e-3 was seen.)
    EXPECT_LT(std::hypot(rest[0], rest[1], rest[2]), 1e-2 * applied) << "at row " << i;
  }
}

double peak_force(const StitchRun& r) {
  double peak = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    peak = std::max(peak, r.at(i, "puncture.peak_force [N]"));
  }
  return peak;
}

TEST(FirstStitch, ShowsThePhysicsAndDoesNotDependOnTheStep) {
  const StitchRun r = run_stitch(10e-3);
  expect_puncture(r);
  expect_friction(r);
  expect_path_holds(r);
  expect_tissue_returns(r);
  expect_momentum_balance(r);

  // Twice the step: less than 5 % in the peak force and in how far the thread has come
  // (docs/validation/step.md has the table).
  const StitchRun coarse = run_stitch(20e-3);
  expect_puncture(coarse);
  EXPECT_NEAR(peak_force(coarse), peak_force(r), 0.05 * peak_force(r));
  const double passed = r.at(r.size() - 1, "path.entry_abscissa [m]");
  EXPECT_NEAR(coarse.at(coarse.size() - 1, "path.entry_abscissa [m]"), passed, 0.05 * passed);
  for (const char* end : {"suture.tip_position", "suture.end_position"}) {
    const auto a = coarse.vector(coarse.size() - 1, end, "m"), b = r.vector(r.size() - 1, end, "m");
    EXPECT_LT(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), 0.05 * passed) << end;
  }
}

}  // namespace
}  // namespace sutura::testing
