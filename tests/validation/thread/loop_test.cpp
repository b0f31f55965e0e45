// A 300 mm thread pulled into a loop of 1 mm radius: adaptive against uniform sampling.
// Reference: planar elastica loop under tension T, l = sqrt(B/T) (tests/reference/a10c_planar_loop.csv):
// end shortening 4 l, largest curvature 2/l, bending energy 4 B/l.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "cubic.h"
#include "reference_table.h"
#include "sampling.h"
#include "unit/thread/rod_builder.h"

namespace sutura::thread {
namespace {

constexpr Real length = 0.3, radius = 1e-3;
constexpr Real l = 2 * radius;  // largest curvature 2/l

/// Polypropylene 4-0.
Section polypropylene() {
  return {.radius = 0.0875e-3, .young = 1.5e9, .poisson = 0.4, .density = 910};
}

struct Errors {
  Index beams = 0;
  Real shortening = 0, curvature = 0;  ///< relative
};

/// Section of the exact loop, apex in the middle.
Pose loop_pose(Real s) {
  const Real u = (s - length / 2) / l;
  const Real angle = 4 * std::atan(std::exp(u));
  return {Vec3(s - 2 * l * std::tanh(u), 2 * l / std::cosh(u), 0),
          Quat(Eigen::AngleAxis<Real>(angle, Vec3::UnitZ()))};
}

/// One end clamped, the other pulled with the dead force T.
void equilibrium(Rod& rod) {
  const Section thread = polypropylene();
  const Real tension = thread.bending_stiffness() / (l * l);
  VecX load = VecX::Zero(rod.dofs());
  load[6 * rod.nodes() - 6] = tension;
  // 1e-6 of T leaves the end where it is within 1e-6 of the shortening. The planar loop is not the
  // lowest equilibrium in space: the shifted steps bring it close, the plain Newton steps of the
  // last third of the iterations finish.
  const auto report = rod.equilibrium(Vec3::Zero(), load, 1e-6 * tension, 45);
  ASSERT_TRUE(report.converged) << rod.beams() << " beams, residual " << report.residual / tension
                                << " T after " << report.iterations;
}

Errors errors(const Rod& rod) {
  const Section thread = polypropylene();
  const Real tension = thread.bending_stiffness() / (l * l);
  const auto& p = rod.poses(Configuration::current);
  // Stretch and shear move the end further, to first order (Castigliano on the elastica:
  // complementary energy T^2/2 (c (L - 8 l/3) + g 8 l/3), l ~ 1/sqrt(T)); c T = 5e-4, so the second
  // order is below 1e-6.
  const Real c = 1 / thread.axial_stiffness(), g = 1 / thread.shear_stiffness();
  const Real stretch = tension * c * length + 2 * (g - c) * tension * l;
  const Real shortening = length + stretch - (p.back().position - p.front().position).x();
  // The curvature of the cubic at the apex, averaged over the two beams that meet there.
  Index apex = 0;
  while (rod.abscissa()[apex] < length / 2 - 1e-9) ++apex;
  const auto bend = [&](Index beam, Real u) {
    const Cubic cubic(p[beam], p[beam + 1], rod.element(beam).length);
    const Vec3 slope = cubic.slope(u);
    return slope.cross(cubic.second(u)).norm() / std::pow(slope.norm(), 3);
  };
  const Real curvature = (bend(apex - 1, 1) + bend(apex, 0)) / 2;
  return {rod.beams(), std::abs(shortening / (4 * l) - 1), std::abs(curvature * l / 2 - 1)};
}

Rod loop_rod(Index beams) {
  RodLayout layout = straight_layout(length, beams, polypropylene());
  for (std::size_t i = 0; i < layout.start.size(); ++i) layout.start[i] = loop_pose(layout.abscissa[i]);
  Rod rod;
  rod.build(layout);
  rod.clamp(0);
  return rod;
}

Errors uniform(Index beams) {
  Rod rod = loop_rod(beams);
  equilibrium(rod);
  return errors(rod);
}

/// From 0.5 mm beams: equilibrium and sampling in turns until the nodes stay.
Errors adaptive(Real angle) {
  Rod rod = loop_rod(600);
  equilibrium(rod);
  SamplingWork work;
  const SamplingRules rules{.angle = angle, .shortest = 0.02e-3, .longest = 20e-3};
  int events = 0;
  for (; events < 40 && sample(rod, rules, work); ++events) {
    rod.resample(
        work.nodes, [](Real s) { return Pose{Vec3(s, 0, 0), Quat::Identity()}; },
        [](Real) { return polypropylene(); });
    // Newton starts from the exact loop, as it does for uniform beams.
    for (Index i = 0; i < rod.nodes(); ++i) rod.state()[i] = loop_pose(rod.abscissa()[i]);
    equilibrium(rod);
  }
  EXPECT_LT(events, 40) << "does not settle";
  return errors(rod);
}

TEST(Loop, ClosedFormIsTheTable) {
  const ReferenceTable table("a10c_planar_loop.csv");
  ASSERT_GT(table.rows.size(), 4u);
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const Real lambda = std::sqrt(table.number(i, "B N m2") / table.number(i, "T N"));
    EXPECT_NEAR(table.number(i, "end shortening m"), 4 * lambda, 1e-8 * lambda);
    EXPECT_NEAR(table.number(i, "max curvature 1/m"), 2 / lambda, 1e-8 / lambda);
  }
}

// With SUTURA_CHART set to a folder it also leaves thread_sampling.csv there (plot_thread.py).
TEST(Loop, AdaptiveNeedsFourTimesFewerBeams) {
  std::vector<Errors> even, sampled;
  for (const Index beams : {150, 300, 600, 1200, 2400}) even.push_back(uniform(beams));
  for (const Real angle : {0.8, 0.4, 0.2, 0.1}) sampled.push_back(adaptive(angle));
  for (const auto* list : {&even, &sampled})
    for (const Errors& e : *list)
      std::printf("%s: %td beams, shortening %.2e, curvature %.2e\n", list == &even ? "uniform" : "adaptive",
                  static_cast<std::ptrdiff_t>(e.beams), e.shortening, e.curvature);
  if (const char* folder = std::getenv("SUTURA_CHART")) {
    std::ofstream csv(std::string(folder) + "/thread_sampling.csv");
    csv << "sampling,beams,shortening_error,curvature_error\n";
    for (const auto* list : {&even, &sampled})
      for (const Errors& e : *list)
        csv << (list == &even ? "uniform" : "adaptive") << ',' << e.beams << ',' << e.shortening << ','
            << e.curvature << '\n';
  }
  // Asked: the accuracy of uniform sampling with at least four times fewer beams, in both quantities.
  for (const Errors& a : {sampled[1], sampled[2]}) {
    const Errors u = uniform(4 * a.beams / 2 * 2);  // even: a node at the apex
    EXPECT_LT(a.shortening, u.shortening) << a.beams;
    EXPECT_LT(a.curvature, u.curvature) << a.beams;
  }
}

}  // namespace
}  // namespace sutura::thread
