// The same scene turned, shifted, and in another unit of length does the same.
//
// Nothing in a scene has a preferred direction or place, so what differs is rounding. How it grows is told apart from a true
// dependence (an axis that a choice hangs on, an absolute tolerance): the difference after the first steps has to be that of
// rounding, and over the script it must not outgrow the difference that a change of the scene by as little as rounding makes.
//
// In a new unit of length, forces and times keep their numbers and every quantity of dimension force^a time^b length^p is
// multiplied by unit^p. With a power of two as the unit all products and sums scale without rounding: whatever differs then is
// a constant of the code that has a dimension. One is known and meant: the solver stops at 1e-5 of 0.1 mm (BlockUnits).
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "house/command.h"
#include "random_scene.h"
#include "watched_run.h"

namespace sutura::testing {
namespace {

struct Trace {
  std::vector<std::vector<Vec3>> points;        ///< per step: thread and tissue, seen from the original scene (m)
  std::vector<std::vector<Mode>> modes;         ///< per step and block
  std::vector<VecX> forces;                     ///< per step: |f| of each block (N)
  std::vector<std::vector<std::uint64_t>> keys;
};

Trace trace(const RandomScene& scene, const View& view, Real tolerance) {
  const house::TemporaryFolder folder("invariance_" + std::to_string(scene.seed));
  WatchedRun run(scene.write(folder.path(), view));
  Trace out;
  if (!run) return out;
  run.solver().tolerance = tolerance;
  for (Index i = 0; i < scene.steps; ++i) {
    run.simulation().step();
    out.points.emplace_back();
    for (const auto& body : run.simulation().bodies())
      for (const Vec3& x : body.body->geometry().points)
        out.points.back().push_back(view.turn.transpose() * (x - view.shift) / view.unit);
    const ConstraintProblem& p = run.simulation().problem();
    out.modes.emplace_back();
    out.keys.emplace_back();
    out.forces.push_back(VecX::Zero(static_cast<Index>(p.blocks.size())));
    for (std::size_t b = 0; b < p.blocks.size(); ++b) {
      out.modes.back().push_back(p.blocks[b].law->event != nullptr ? p.blocks[b].mode : 0);
      out.keys.back().push_back(p.blocks[b].key.value);
      out.forces.back()[static_cast<Index>(b)] =
          p.lambda.segment(p.blocks[b].first_row, p.blocks[b].law->dim).norm();
    }
  }
  return out;
}

struct Difference {
  std::vector<Real> position, force;  ///< per step, largest (m, N)
  std::size_t events = 0;             ///< first step with other blocks or other events; number of steps if none
};

Difference difference(const Trace& a, const Trace& b) {
  Difference d;
  d.events = a.points.size();
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    Real most = 0;
    for (std::size_t n = 0; n < a.points[i].size(); ++n) most = std::max(most, (a.points[i][n] - b.points[i][n]).norm());
    d.position.push_back(most);
    if (d.events == a.points.size() && (a.keys[i] != b.keys[i] || a.modes[i] != b.modes[i])) d.events = i;
    d.force.push_back(i < d.events && a.forces[i].size() > 0 ? (a.forces[i] - b.forces[i]).cwiseAbs().maxCoeff() : 0);
  }
  return d;
}

void print(const char* name, std::uint64_t seed, const Difference& d) {
  std::printf("%-9s seed %2lu steps %zu events differ at %zu;", name, static_cast<unsigned long>(seed), d.position.size(), d.events);
  for (std::size_t i = 0; i < d.position.size(); i += 4) std::printf(" %.0e", d.position[i]);
  std::printf(" | force %.0e\n", *std::max_element(d.force.begin(), d.force.end()));
}

class Invariance : public ::testing::TestWithParam<int> {};

TEST_P(Invariance, TurnedShiftedAndInAnotherUnit) {
  const RandomScene scene(static_cast<std::uint64_t>(GetParam()));
  constexpr Real tolerance = 1e-9;
  const Trace base = trace(scene, {}, tolerance);
  std::mt19937_64 random(scene.seed);
  std::normal_distribution<Real> normal;
  const auto some = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  const Quat turn = Quat(normal(random), normal(random), normal(random), normal(random)).normalized();

  print("repeat", scene.seed, difference(base, trace(scene, {}, tolerance)));
  print("nudged", scene.seed, difference(base, trace(scene, {.shift = 1e-15 * some()}, tolerance)));
  print("shifted", scene.seed, difference(base, trace(scene, {.shift = 0.05 * some()}, tolerance)));
  print("turned", scene.seed, difference(base, trace(scene, {.turn = turn.toRotationMatrix()}, tolerance)));
  print("unit 1024", scene.seed, difference(base, trace(scene, {.unit = 1024}, tolerance)));
  print("unit 1000", scene.seed, difference(base, trace(scene, {.unit = 1000}, tolerance)));
}

INSTANTIATE_TEST_SUITE_P(Seeds, Invariance, ::testing::Range(1, 13));

}  // namespace
}  // namespace sutura::testing
