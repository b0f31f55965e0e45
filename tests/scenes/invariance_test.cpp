// The same scene turned, shifted, and in another unit of length does the same.
//
// Nothing in a scene has a preferred direction or place, so what differs is rounding. How it grows
// is told apart from a true dependence (an axis that a choice hangs on, an absolute tolerance): the
// difference after the first steps has to be that of rounding, and over the script it must not
// outgrow the difference that a change of the scene by as little as rounding makes.
//
// In a new unit of length, forces and times keep their numbers and every quantity of dimension
// force^a time^b length^p is multiplied by unit^p. With a power of two as the unit all products and
// sums scale without rounding: whatever differs then is a constant of the code that has a
// dimension. One is known and meant: the solver stops at 1e-5 of 0.1 mm (BlockUnits).
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <string_view>

#include "house/command.h"
#include "random_scene.h"
#include "sutura/units.h"
#include "tissue_meshes.h"
#include "watched_run.h"

namespace sutura::testing {
namespace {

struct Trace {
  std::vector<std::vector<Vec3>>
      points;  ///< per step: thread and tissue, seen from the original scene (m)
  std::vector<std::vector<Mode>> modes;  ///< per step and block, of punctures
  std::vector<VecX> forces;              ///< per step: |f| of each block (N)
  std::vector<std::vector<std::uint64_t>> keys;
};

Trace trace(WatchedRun& run, const View& view, Index steps) {
  Trace out;
  for (Index i = 0; i < steps; ++i) {
    // A step that says that it is not solved has no one answer.
    if (!run.simulation().step().solved) break;
    out.points.emplace_back();
    for (const auto& body : run.simulation().bodies())
      for (const Vec3& x : body.body->geometry().points)
        out.points.back().push_back(view.turn.transpose() * (x - view.shift) / view.unit);
    const ConstraintProblem& p = run.simulation().problem();
    out.modes.emplace_back();
    out.keys.emplace_back();
    out.forces.push_back(VecX::Zero(static_cast<Index>(p.blocks.size())));
    for (std::size_t b = 0; b < p.blocks.size(); ++b) {
      const bool punctures = std::string_view(p.blocks[b].law->name) == "puncture";
      out.modes.back().push_back(punctures ? p.blocks[b].mode : 0);
      out.keys.back().push_back(p.blocks[b].key.value);
      out.forces.back()[static_cast<Index>(b)] =
          p.lambda.segment(p.blocks[b].first_row, p.blocks[b].law->dim).norm();
    }
  }
  return out;
}

/// Steps are solved until little is left (tight), so that where they stop does not count.
LoadOptions tight(Real unit = 1) {
  return {.plugin_directories = {},
          .overrides = {{".tolerance", "1e-4"},
                        {".gap_tolerance", format_real(2e-9 * unit) + " m"},
                        {".passes", "40"}}};
}

Trace trace(const RandomScene& scene, const View& view) {
  const house::TemporaryFolder folder("invariance_" + std::to_string(scene.seed));
  WatchedRun run(scene.write(folder.path(), view), tight(view.unit), true);
  if (!run) return {};
  run.solver().tolerance = 1e-9;  // where the solver stops is not what is asked here
  return trace(run, view, scene.steps);
}

struct Difference {
  std::vector<Real> position, force;  ///< per step, largest (m, N)
  std::size_t events =
      0;  ///< first step with other blocks or other events; number of steps if none
};

Difference difference(const Trace& a, const Trace& b) {
  Difference d;
  const std::size_t steps = std::min(a.points.size(), b.points.size());
  d.events = steps;
  for (std::size_t i = 0; i < steps; ++i) {
    Real most = 0;
    for (std::size_t n = 0; n < a.points[i].size(); ++n)
      most = std::max(most, (a.points[i][n] - b.points[i][n]).norm());
    d.position.push_back(most);
    if (d.events == steps && (a.keys[i] != b.keys[i] || a.modes[i] != b.modes[i])) d.events = i;
    d.force.push_back(i < d.events && a.forces[i].size() > 0
                          ? (a.forces[i] - b.forces[i]).cwiseAbs().maxCoeff()
                          : 0);
  }
  return d;
}

Real worst(const Difference& d) {
  return d.position.empty() ? 0 : *std::max_element(d.position.begin(), d.position.end());
}

/// Results agree to what rounding alone does to this scene: `nudged`.
/// A turn rounds every coordinate of every node, a nudge some: 1000 times is the factor allowed
/// between them (measured: 25 at most), where a dependence on an axis would show at once with the
/// size of a step, 1e-5 m and more.
void expect_rounding(const char* what, const Difference& d, const std::vector<Difference>& nudged) {
  Real bound = 1e-9;
  std::size_t events = d.position.size();
  for (const Difference& n : nudged) events = std::min(events, n.events);
  Real ratio = 0;
  for (std::size_t i = 0; i < d.position.size(); ++i) {
    for (const Difference& n : nudged)
      if (i < n.position.size()) bound = std::max(bound, n.position[i]);
    EXPECT_LE(d.position[i], 1000 * bound) << what << " step " << i;
    ratio = std::max(ratio, d.position[i] / bound);
  }
  // The same blocks and events in every step, or as far as rounding lets this scene go.
  EXPECT_GE(d.events, events) << what;
  ::testing::Test::RecordProperty(what, std::to_string(worst(d)));
  std::printf("%-8s differs by at most %.1e m, %.1f times rounding, events up to step %zu of %zu\n",
              what, worst(d), ratio, d.events, d.position.size());
}

Vec3 some(std::mt19937_64& random) {
  std::normal_distribution<Real> normal;
  return Vec3(normal(random), normal(random), normal(random));
}
Mat3 some_turn(std::mt19937_64& random) {
  return Eigen::AngleAxis<Real>(1 + some(random).norm(), some(random).normalized())
      .toRotationMatrix();
}

class Invariance : public ::testing::TestWithParam<int> {};

TEST_P(Invariance, RandomSceneTurnedShiftedAndInAnotherUnit) {
  const RandomScene scene(static_cast<std::uint64_t>(GetParam()));
  const Trace base = trace(scene, {});
  const auto seen = [&](const View& view) { return difference(base, trace(scene, view)); };
  std::mt19937_64 random(scene.seed);

  const Difference again = seen({});
  EXPECT_EQ(worst(again), 0);
  EXPECT_EQ(again.events, base.points.size());
  EXPECT_GE(base.points.size(), 20u);  // so many steps are solved that tightly

  // All lengths larger or smaller by the last bit or two: the same scene to 4e-16.
  const std::vector<Difference> nudged{seen({.unit = 1 + 0x1p-51}), seen({.unit = 1 - 0x1p-51})};
  expect_rounding("turned", seen({.turn = some_turn(random)}), nudged);
  expect_rounding("shifted", seen({.shift = 0.05 * some(random)}), nudged);
  for (const Real unit : {1024., 1000., 1. / 1024}) {
    const Difference d = seen({.unit = unit});
    if (!scene.approximate) {
      expect_rounding("unit", d, nudged);
      continue;
    }
    // An approximate W is good enough at 1e-6 m, whatever the unit of length (docs/step.md, stage
    // 8): what is left of it after a step is carried along by some steps. In a unit of a kilometre
    // that is a millimetre: nobody asks for that.
    if (unit > 1) {
      EXPECT_LE(worst(d), 2e-5);
    }
  }
}

// Of the first dozen, those whose steps can be solved that tightly: the others hold a thread so
// soft that rounding is more than a ten-thousandth of what is at work on it.
INSTANTIATE_TEST_SUITE_P(Seeds, Invariance, ::testing::Values(1, 2, 5, 6, 7, 9, 10, 11));

/// scenes/suture/first_stitch.xml from another side: its mesh written anew, its vectors replaced in
/// the text.
class TurnedStitch {
 public:
  explicit TurnedStitch(const std::filesystem::path& folder) : folder_(folder) {}
  void take_mesh_of_the_scene() {
    WatchedRun run(source);
    const BodyGeometry pad = run.body<SolidBody>().geometry();
    mesh_ = {};
    mesh_.points = pad.points;
    for (std::size_t e = 0; e < pad.connectivity.size(); e += 4)
      mesh_.tets.push_back({pad.connectivity[e], pad.connectivity[e + 1], pad.connectivity[e + 2],
                            pad.connectivity[e + 3]});
    for (const auto& field : pad.fields)
      if (field.name == "region")
        for (const Real r : field.values) mesh_.region.push_back(static_cast<int>(r));
  }
  /// A pad of the same size, small enough for a direct solver. The needle's plane meets no node.
  void take_coarse_mesh() {
    mesh_ = test::kuhn_block({11, 5, 4}, Vec3(50e-3, 30e-3, 10e-3));
    for (Vec3& p : mesh_.points) p -= Vec3(25e-3, 15e-3, 10e-3);
    for (std::size_t e = 0; e < mesh_.tets.size(); ++e)
      mesh_.region[e] = e < mesh_.tets.size() * 3 / 4 ? 2 : 1;
  }

  /// `solver`: XML in place of the scene's tissue solver, or none.
  Trace run(const View& view, Index steps, const std::string& solver = {}) {
    tissue::MeshData mesh = mesh_;
    for (Vec3& p : mesh.points) p = view.point(p);
    test::write_msh(mesh, folder_ / "pad.msh");
    std::string bed;
    for (std::size_t i = 0; i < mesh_.points.size(); ++i)
      if (mesh_.points[i].z() < -9.999e-3) bed += std::to_string(i) + ' ';
    std::string text = house::read_text(source);
    const auto replace = [&](const std::string& from, const std::string& to) {
      const std::size_t at = text.find(from);
      ASSERT_NE(at, std::string::npos) << from;
      text.replace(at, from.size(), to);
    };
    const auto vectors = [&](const std::string& name, const std::string& old,
                             const std::string& unit, bool points) {
      std::string error, now;
      const auto values = parse_quantities(old + (unit.empty() ? "" : " " + unit),
                                           unit == "deg"  ? "rad"
                                           : unit.empty() ? "1"
                                                          : "m",
                                           error);
      ASSERT_TRUE(values) << error;
      for (std::size_t i = 0; i < values->size(); i += 3) {
        const Vec3 v((*values)[i], (*values)[i + 1], (*values)[i + 2]);
        const Vec3 w = points ? view.point(v) : view.direction(v);
        for (const Real x : w) now += format_real(x) + ' ';
      }
      replace(name + "=\"" + old + (unit.empty() ? "" : " " + unit) + '"',
              name + "=\"" + now + '"');
    };
    replace("file=\"../meshes/pad.msh\" unit=\"mm\"", "file=\"pad.msh\" unit=\"m\"");
    replace("region=\"dermis\"", "region=\"" + std::to_string(mesh_.region[dermis()]) + '"');
    replace("box=\"-25 -15 -10  25 15 -10 mm\"", "nodes=\"" + bed + '"');
    vectors("gravity", "0 0 -9.81", "", false);
    vectors("tip", "-7.374 0 1.243", "mm", true);
    vectors("tip_direction", "0.454 0 -0.891", "", false);
    vectors("plane_normal", "0 -1 0", "", false);
    vectors("thread_direction", "0.1 0 1", "", false);
    vectors("centre", "0 0 5", "mm", true);
    vectors("rotations", "0 0 0  0 -161 0", "deg", false);
    vectors("positions", "0 0 0  -65 0 22  -65 0 22  -65 0 0  -60 0 -50", "mm", false);
    if (!solver.empty()) replace("<AsyncPreconditioner lag=\"3\"/>", solver);
    const std::size_t recorders = text.find("<VtuRecorder"), end = text.find("</sutura>");
    text.replace(recorders, end - recorders, "<WatchedSolver/>\n");
    std::ofstream(folder_ / "stitch.xml") << text;
    WatchedRun run(folder_ / "stitch.xml", tight(view.unit), true);
    run.solver().tolerance = 1e-9;
    return trace(run, view, steps);
  }

 private:
  /// A tet at the top.
  std::size_t dermis() const {
    for (std::size_t e = 0; e < mesh_.tets.size(); ++e)
      for (const Index n : mesh_.tets[e])
        if (mesh_.points[static_cast<std::size_t>(n)].z() > -1e-9) return e;
    throw std::logic_error("no tet at the top");
  }
  static constexpr const char* source = SUTURA_SOURCE_DIR "/scenes/suture/first_stitch.xml";
  std::filesystem::path folder_;
  tissue::MeshData mesh_;
};

TEST(FirstStitch, IsTheSameFromEverySide) {
  const house::TemporaryFolder folder("turned_stitch");
  TurnedStitch stitch(folder.path());
  constexpr Index steps = 80;  // 0.8 s: the tip is through the skin and well inside
  const std::string exact = "<DirectSolver/>";
  stitch.take_coarse_mesh();
  std::mt19937_64 random(1);
  const Trace base = stitch.run({}, steps, exact);
  const Difference again = difference(base, stitch.run({}, steps, exact));
  EXPECT_EQ(worst(again), 0);
  const Mat3 hair = Eigen::AngleAxis<Real>(3e-15, some(random).normalized()).toRotationMatrix();
  const std::vector<Difference> nudged{
      difference(base, stitch.run({.turn = hair}, steps, exact)),
      difference(base, stitch.run({.shift = 1e-17 * some(random)}, steps, exact))};
  const View turned{.turn = some_turn(random)}, shifted{.shift = 0.05 * some(random)};
  expect_rounding("turned", difference(base, stitch.run(turned, steps, exact)), nudged);
  expect_rounding("shifted", difference(base, stitch.run(shifted, steps, exact)), nudged);
  std::size_t punctures = 0;
  for (std::size_t i = 0; i < base.modes.size(); ++i)
    for (const Mode m : base.modes[i]) punctures += m != 0;
  EXPECT_GE(punctures, 1u);

  // The needle's plane meets edges of the scene's own mesh: which of two triangles the tip touches
  // is a matter of rounding there, and the points of its footprint lie along an edge of that one.
  stitch.take_mesh_of_the_scene();
  const Trace approximate = stitch.run({}, steps);
  EXPECT_EQ(worst(difference(approximate, stitch.run({}, steps))), 0);
  const Difference seen = difference(approximate, stitch.run(turned, steps));
  std::printf("with AsyncPreconditioner: at most %.1e m, events up to step %zu\n", worst(seen),
              seen.events);
  EXPECT_LE(worst(seen), 5e-5);  // measured 1.4e-5; the tip is 4e-4 m wide
  EXPECT_EQ(seen.events, static_cast<std::size_t>(steps));
}

}  // namespace
}  // namespace sutura::testing
