// Touches found, missed and made in vain. Missed: along the way of each step, looked at in a
// hundred parts, strands come into what they touch by more than a tenth of their thickness, and no
// touch was built near; of steps that are solved, the others say that they are not. In vain: built,
// and without force at the end of the step.
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <random>

#include "contact_scenes.h"
#include "scenes/text_run.h"
#include "stability/contact/crossings.h"

namespace sutura::testing {
namespace {

constexpr Real r = 0.1e-3;         // m, of all threads here
constexpr Real allowed = 0.2 * r;  // m: a tenth of the thickness
constexpr Real near = 1.5e-3;      // m: a beam and a half
constexpr int looks = 100;         // in a step
constexpr int parts = 4;           // of a beam, each shorter than it is thick by little

struct Count {
  int found = 0, in_vain = 0, missed = 0, unsolved = 0;
  void print(const char* name) const {
    std::printf("%s: %d touches with force, %d in vain, %d missed; %d steps not solved\n", name,
                found, in_vain, missed, unsolved);
  }
};

/// Runs without dividing steps, so that ways are straight, and asks `overlaps(before, after, time,
/// place)` at every look: it calls place(p) where something is too deep in something.
template <class Lines, class Overlaps>
void run(TextRun& world, Real seconds, Count& count, const Lines& lines, const Overlaps& overlaps) {
  auto before = lines();
  while (world.simulation().time() < seconds - 1e-9) {
    const StepReport& report = world.simulation().step();
    ASSERT_TRUE(report.finite);
    const ConstraintProblem& problem = world.simulation().problem();
    std::vector<Vec3> touches;
    for (const ConstraintBlock& b : problem.blocks) {
      if (b.law->dim != 3) continue;  // Coulomb; the springs for normals that turn have one row
      touches.push_back(b.at);
      ++(problem.lambda[b.first_row] > 0 ? count.found : count.in_vain);
    }
    const auto after = lines();
    count.unsolved += !report.solved;
    for (int k = 1; k <= looks && report.solved; ++k)
      overlaps(before, after, Real(k) / looks, [&](const Vec3& p) {
        for (const Vec3& t : touches)
          if ((t - p).norm() < near) return;
        ++count.missed;
      });
    before = after;
  }
}

Vec3 between(const Vec3& a, const Vec3& b, Real time) {
  return a + time * (b - a);
}

/// Strands of two lines, or of one that are further apart along it than `apart` (points).
template <class Place>
void overlaps_of(const Line& a0, const Line& a1, const Line& b0, const Line& b1, std::size_t apart,
                 Real time, const Place& place) {
  for (std::size_t i = 0; i < a0.size(); ++i) {
    const Vec3 p = between(a0[i], a1[i], time);
    for (std::size_t j = apart > 0 ? i + apart : 0; j + 1 < b0.size(); ++j) {
      const Segment s{between(b0[j], b1[j], time), between(b0[j + 1], b1[j + 1], time)};
      if ((s.at(closest_point(p, s)) - p).norm() < 2 * r - allowed) place(p);
    }
  }
}

std::string falling(std::mt19937& random, Real height) {
  std::uniform_real_distribution<Real> anywhere(-1, 1);
  const Real angle = 1 + 0.8 * anywhere(random);
  return thread("a", Vec3(2e-3 * anywhere(random), 2e-3 * anywhere(random), height),
                Vec3(std::cos(angle), std::sin(angle), 0), 0.02, 20,
                "velocity='0 0 " + std::to_string(-0.5 + 0.4 * anywhere(random)) + "'");
}

TEST(Found, OnABar) {
  Count count;
  constexpr Real radius = 1e-3;
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 random(seed);
    TextRun world(
        "<plugin name='contact'/>" + falling(random, 3e-3) +
            "<Tool name='bar' shape='cylinder' axis='1 0 0' length='60 mm' radius='1 mm'/>"
            "<Contact tool='bar' friction='0.3'/>",
        "dt='5 ms' substeps='1'");
    ASSERT_TRUE(world) << world.said();
    const auto& a = world.component<SegmentedCurve>("/a");
    run(
        world, 0.15, count, [&] { return line_of(a, parts); },
        [&](const Line& from, const Line& to, Real time, const auto& place) {
          for (std::size_t i = 0; i < from.size(); ++i) {
            const Vec3 p = between(from[i], to[i], time);
            if (p.tail<2>().norm() < radius + r - allowed) place(p);
          }
        });
  }
  count.print("thread on a bar");
  EXPECT_EQ(count.missed, 0);
  EXPECT_GT(count.found, 40);
}

TEST(Found, OnAThread) {
  Count count;
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 random(100 + seed);
    TextRun world("<plugin name='contact'/>" + falling(random, 1e-3) +
                      thread("b", Vec3::Zero(), Vec3::UnitX(), 0.06, 60, "clamp='both'") +
                      "<Contact first='a' second='b' friction='0.3'/>",
                  "dt='5 ms' substeps='1'");
    ASSERT_TRUE(world) << world.said();
    const auto &a = world.component<SegmentedCurve>("/a"),
               &b = world.component<SegmentedCurve>("/b");
    run(
        world, 0.15, count, [&] { return std::pair(line_of(a, parts), line_of(b, parts)); },
        [&](const auto& from, const auto& to, Real time, const auto& place) {
          overlaps_of(from.first, to.first, from.second, to.second, 0, time, place);
        });
  }
  count.print("thread on a thread");
  EXPECT_EQ(count.missed, 0);
  EXPECT_GT(count.found, 40);
}

// A coil of one turn and a quarter, as it is at rest; its last quarter is pressed down on its
// first.
TEST(Found, OnItself) {
  Count count;
  const std::string file = SUTURA_BINARY_DIR "/loop.csv";
  const Real R = 4e-3, rise = 1e-3 / (2 * std::numbers::pi), square = R * R + rise * rise;
  std::ofstream(file) << "s [m],curvature [1/m],torsion [1/m]\n0," << R / square << ','
                      << rise / square << '\n';
  const Real length = 2.5 * std::numbers::pi * std::sqrt(square);
  TextRun world(
      "<plugin name='contact'/><SutureThread name='a' needle_length='0' thread='4-0 polypropylene' "
      "thread_diameter='0.2 mm' thread_length='" +
          std::to_string(length) + "' thread_beams='50' tip_direction='-1 0 0' thread_rest_file='" +
          file + "' thread_start_file='" + file +
          "'/><Track name='hand' times='0 0.1 s' positions='0 0 0 0 0 1.6 mm'/><Track name='rest' "
          "times='0'/><Grasper name='first' track='rest' at='0'/><Grasper name='last' track='hand' "
          "at='" +
          std::to_string(length) + "'/><Contact friction='0.3'/>",
      "dt='5 ms' gravity='0 0 0' substeps='1'");
  ASSERT_TRUE(world) << world.said();
  const auto& a = world.component<SegmentedCurve>("/a");
  run(
      world, 0.3, count, [&] { return line_of(a, parts); },
      [&](const Line& from, const Line& to, Real time, const auto& place) {
        constexpr std::size_t apart = 8 * parts;  // 5.5 mm: no bend is that tight
        overlaps_of(from, to, from, to, apart, time, place);
      });
  count.print("thread on itself");
  EXPECT_EQ(count.missed, 0);
  EXPECT_GT(count.found, 40);
}

}  // namespace
}  // namespace sutura::testing
