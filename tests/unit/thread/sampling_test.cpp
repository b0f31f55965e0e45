#include "sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "divided_step.h"
#include "rod_static.h"
#include "sampling_events.h"

namespace sutura::thread {
namespace {

constexpr Real length = 0.3;
constexpr Real beam_length = 2e-3;

Section soft(Real) {
  return {.radius = 1e-4, .young = 1e9, .poisson = 0.4, .density = 1140, .bending_factor = 0.05};
}

/// A free straight-rest thread laid along a plane curve given by its tangent angle.
Rod plane_rod(Index beams, const std::function<Real(Real)>& angle) {
  RodLayout layout = straight_layout(length, beams, nylon());
  Vec3 x = Vec3::Zero();
  for (Index i = 0; i <= beams; ++i) {
    const Real s = layout.abscissa[i];
    if (i > 0) {
      const Real from = layout.abscissa[i - 1];
      for (int k = 0; k < 100; ++k) {
        const Real a = angle(from + (k + 0.5) / 100 * (s - from));
        x += (s - from) / 100 * Vec3(std::cos(a), std::sin(a), 0);
      }
    }
    layout.start[i] = {x, Quat(Eigen::AngleAxis<Real>(angle(s), Vec3::UnitZ()))};
  }
  Rod rod;
  rod.build(layout);
  return rod;
}

/// Samples until nothing changes; returns the number of events.
int settle(Rod& rod, const SamplingRules& rules, int most = 30) {
  for (int i = 0; i < most; ++i) {
    bool changed = false;
    const auto nodes = sample(rod, rules, changed);
    if (!changed) return i;
    Resampler().apply(rod, nodes, rest_pose, section);
  }
  ADD_FAILURE() << "does not settle";
  return most;
}

/// One soft beam of 2 mm, at rest an arc of `rest` rad, whose sections are turned by a and b (rad)
/// against its chord, about axes 0.3 rad apart, and which is not strained.
Rod one_beam(const std::function<Pose(Real)>& rest, Real a, Real b) {
  RodLayout layout;
  layout.abscissa = {0, beam_length};
  layout.rest = {rest(0), rest(beam_length)};
  layout.sections = {soft(0)};
  const Vec3 aside(0, std::sin(0.3), std::cos(0.3));
  layout.start = {{Vec3::Zero(), Quat(Eigen::AngleAxis<Real>(a, Vec3::UnitZ()))},
                  {Vec3(beam_length, 0, 0), Quat(Eigen::AngleAxis<Real>(b, aside))}};
  Rod rod;
  rod.build(layout);
  ElementState state;
  for (int i = 0; i < 3; ++i) {
    rod.element_state(0, state);
    rod.poses()[1].position.x() -= beam_length * state.strain;
  }
  return rod;
}

struct Bend {
  Real rest, a, b;  // rad
};
void PrintTo(const Bend& bend, std::ostream* out) {
  *out << "at rest " << bend.rest << ", now " << bend.a << " and " << bend.b;
}
class SplitBeam : public ::testing::TestWithParam<Bend> {};

// The chords of the halves of an S go one way: the node between them can make them longer or
// shorter only by its tilt, that of an arc only by a shift across. EA is 8e6 EI / L^2 here.
TEST_P(SplitBeam, KeepsItsStrainAndEnergyWhateverItsShape) {
  const auto [turn, a, b] = GetParam();
  const Real curvature = turn / beam_length;
  const auto rest = [curvature](Real s) {
    const Real angle = curvature * s;
    const Vec3 x =
        curvature > 0 ? Vec3(std::sin(angle), 1 - std::cos(angle), 0) / curvature : Vec3(s, 0, 0);
    return Pose{x, Quat(Eigen::AngleAxis<Real>(angle, Vec3::UnitZ()))};
  };
  Rod rod = one_beam(rest, a, b);
  const Real before = rod.elastic_energy();
  Resampler().apply(rod, {0, beam_length / 2, beam_length}, rest, soft);
  // Asked: below 1 %.
  EXPECT_NEAR(rod.elastic_energy(), before, 0.01 * before);
  ElementState state;
  for (const Index e : {0, 1}) {
    rod.element_state(e, state);
    // What whole and halves differ by in their rest shapes, turn^4 / 1920, where they are straight
    // and nothing can be done about it; else rounding of four Newton steps.
    const bool straight = std::max(std::abs(a), std::abs(b)) < 0.02;
    EXPECT_LT(std::abs(state.strain), straight ? std::pow(turn, 4) / 1920 + 1e-10 : 1e-10) << e;
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, SplitBeam,
                         ::testing::Values(Bend{0, 0.2, 0.2}, Bend{0, 0.3, 0.3}, Bend{0, -0.3, 0.3},
                                           Bend{0, 0.05, -0.3}, Bend{0, 0.1, 0.11}, Bend{0.3, 0, 0},
                                           Bend{0.3, 0.01, 0.01}, Bend{0.3, 0.2, 0.2},
                                           Bend{0.3, -0.15, 0.15}, Bend{0.3, 0.15, -0.15},
                                           Bend{0.3, 0.1, 0.12}));

// Nodes come and go around a rigid stretch; its own stay, and it is the same stretch.
TEST(Sampling, LeavesARigidStretchAlone) {
  Rod rod = plane_rod(20, [](Real s) { return 3 * std::sin(30 * s); });
  rod.make_rigid({7, 5, 9});
  const std::vector<Pose> before = rod.poses();
  EXPECT_GT(settle(rod, {.angle = 0.3, .shortest = 1e-3}), 0);
  ASSERT_GT(rod.nodes(), 30);
  ASSERT_EQ(rod.stretches().all().size(), 1u);
  const RigidStretch now = rod.stretches().all().front();
  EXPECT_EQ(now.body, 7);
  ASSERT_EQ(now.last - now.first, 4);
  for (Index i = 0; i <= 4; ++i) {
    EXPECT_NEAR(rod.abscissa()[now.first + i], length * static_cast<Real>(5 + i) / 20, 1e-12);
    EXPECT_EQ(rod.poses()[now.first + i].position, before[5 + i].position);
  }
}

TEST(Sampling, AnSIsNotStraight) {
  // End tangents of the beam agree: the angle between them says straight, its integral does not.
  Rod s_shape =
      plane_rod(1, [](Real s) { return 0.5 * std::sin(2 * std::numbers::pi * s / length); });
  Pose& end = s_shape.poses()[1];
  end.position = Vec3(0.28, 0, 0);
  s_shape.poses()[0].rotation = end.rotation = Quat(Eigen::AngleAxis<Real>(0.4, Vec3::UnitZ()));
  // The cubic's slope runs from 0.4 to about -0.2 and back: 1.2 rad in all.
  EXPECT_NEAR(turning_angle(s_shape, 0), 1.2, 0.15);
  bool changed = false;
  EXPECT_EQ(sample(s_shape, {.angle = 0.3, .shortest = 1e-3}, changed).size(), 3u);
  EXPECT_TRUE(changed);
}

TEST(Sampling, DenseWhereItBends) {
  // A bend of 2 rad within 20 mm in the middle of 300 mm.
  Rod rod = plane_rod(10, [](Real s) { return 2 / (1 + std::exp(-(s - 0.15) / 3e-3)); });
  const SamplingRules rules{.angle = 0.2, .shortest = 0.5e-3, .longest = 30e-3};
  settle(rod, rules);
  const auto& a = rod.abscissa();
  for (Index e = 0; e < rod.beams(); ++e) {
    EXPECT_LE(turning_angle(rod, e), rules.angle + 1e-12);
    const Real l = a[e + 1] - a[e];
    if (e > 0) {
      const Real before = a[e] - a[e - 1];
      EXPECT_LE(std::max(l, before) / std::min(l, before), 2 + 1e-6) << e;
    }
  }
  // Uniform beams of the finest length would be many times more.
  Real finest = length;
  for (Index e = 0; e < rod.beams(); ++e) finest = std::min(finest, a[e + 1] - a[e]);
  EXPECT_GT(length / finest, 4 * static_cast<Real>(rod.beams()));
}

TEST(Sampling, StraightensBackToCoarse) {
  Rod rod = plane_rod(10, [](Real s) { return 2 / (1 + std::exp(-(s - 0.15) / 3e-3)); });
  const SamplingRules rules{.angle = 0.2, .shortest = 0.5e-3, .longest = 30e-3};
  settle(rod, rules);
  ASSERT_GT(rod.beams(), 20);
  for (Index i = 0; i < rod.nodes(); ++i) rod.poses()[i] = rest_pose(rod.abscissa()[i]);
  settle(rod, rules);
  EXPECT_EQ(rod.beams(), 10);
}

TEST(Sampling, ForcedNodesStay) {
  Rod rod = plane_rod(64, [](Real) { return 0; });
  const Real forced = rod.abscissa()[13];
  settle(rod, {.angle = 0.2, .shortest = 1e-3, .longest = 1, .forced = {forced}});
  const auto& a = rod.abscissa();
  EXPECT_NE(std::find(a.begin(), a.end(), forced), a.end());
  EXPECT_LT(rod.beams(), 20);
}

TEST(Sampling, MomentumIsConservedAndEnergyHardlyMoves) {
  std::mt19937 engine(11);
  std::uniform_real_distribution<Real> uniform(-1, 1);
  Rod rod = plane_rod(20, [](Real s) { return 1.5 * std::sin(2 * std::numbers::pi * s / length); });
  // A smooth motion, turning and twisting.
  for (Index i = 0; i < rod.nodes(); ++i) {
    const Vec3 x = rod.poses(Configuration::current)[i].position;
    const Vec3 spin(2, -1, 3);
    rod.velocity().segment<3>(6 * i) =
        Vec3(0.1, 0.2, -0.3) + spin.cross(x) + Vec3(0, 0, std::sin(20 * x.x()));
    rod.velocity().segment<3>(6 * i + 3) = spin + Vec3(1, -20 * std::cos(20 * x.x()), 0);
  }
  // Settle the bending energy first: the rod's own shape, not the one it was drawn with.
  const Vec3 p = rod.momentum(), l = rod.angular_momentum();
  int events = 0;
  for (const Real angle : {0.2, 0.1, 0.8, 0.05, 1.5}) {
    for (int i = 0; i < 10; ++i) {
      bool changed = false;
      const auto nodes =
          sample(rod, {.angle = angle, .shortest = 0.2e-3, .longest = 30e-3}, changed);
      if (!changed) break;
      const Real bending = rod.elastic_energy();
      const bool refined = nodes.size() > rod.abscissa().size();
      Resampler().apply(rod, nodes, rest_pose, section);
      ++events;
      // Asked: 1e-10 per event.
      EXPECT_LT((rod.momentum() - p).norm(), 1e-10 * p.norm()) << angle;
      EXPECT_LT((rod.angular_momentum() - l).norm(), 1e-10 * l.norm()) << angle;
      // Asked: below 1 % of the bending energy of the beams concerned (here: all of them).
      if (refined) {
        EXPECT_NEAR(rod.elastic_energy(), bending, 0.01 * bending) << angle;
      }
    }
  }
  EXPECT_GT(events, 5);
}

TEST(Sampling, EveryEventKeepsTheEnergyOfItsBeams) {
  // A thread bent to an arch by its clamped ends, at equilibrium; finer rules, then coarser ones.
  Rod rod = plane_rod(64, [](Real s) { return 1.5 * std::sin(2 * std::numbers::pi * s / length); });
  rod.clamp(0);
  rod.clamp(64);
  const auto rest = [&] {
    const auto report = equilibrium(rod, Vec3::Zero(), VecX::Zero(rod.dofs()), 1e-9);
    ASSERT_TRUE(report.converged) << report.residual;
  };
  Jumps jumps;
  for (const Real angle : {0.2, 0.1, 0.05, 0.15, 0.3, 0.6})
    for (int i = 0; i < 10; ++i) {
      rest();
      if (!resample_and_compare(rod, {.angle = angle, .shortest = 0.2e-3, .longest = 0.1}, jumps))
        break;
    }
  std::printf("at rest: %s\n", jumps.text().c_str());
  EXPECT_GT(jumps.splits, 20);
  EXPECT_GT(jumps.merges, 20);
  // Asked: below 1 % of the bending energy of the beams concerned.
  EXPECT_LT(jumps.split, 0.01);
  EXPECT_LT(jumps.merge, 0.01);
}

TEST(Sampling, DoesNotFlickerAtRest) {
  // A heavy thread hangs between two pins and swings out; then 1000 steps without an event.
  Rod rod = plane_rod(20, [](Real s) { return 0.8 - 1.6 * s / length; });
  rod.clamp(0);
  rod.clamp(20);
  RodStep step(rod);
  const SamplingRules rules{.angle = 0.15, .shortest = 1e-3, .longest = 30e-3};
  int last_event = 0;
  const int steps = 1500;
  for (int i = 0; i < steps; ++i) {
    ASSERT_TRUE(divided_step(rod, step, 0.02, Vec3(0, -9.81, 0))) << i;
    bool changed = false;
    const auto nodes = sample(rod, rules, changed);
    if (!changed) continue;
    Resampler().apply(rod, nodes, rest_pose, section);
    step.fit(rod);
    last_event = i;
  }
  EXPECT_LT(last_event, steps - 1000);
}

}  // namespace
}  // namespace sutura::thread
