// A 300 mm thread pulled into a loop, apex in the middle: exact solution, rods, errors. For test
// and benchmark.
//
// Plane elastica under a tension T (the separatrix of EI theta'' = T sin(theta)), l = sqrt(EI/T), u
// = s/l:
//   theta = 4 atan(exp(u)), x = s - 2 l tanh(u), y = -2 l (1 - 1/cosh(u)), all from the apex.
// End shortening 4 l, largest curvature 2/l, height 2 l: tests/reference/a10c_planar_loop.csv. In
// space a plane loop is stable only if its middle is kept from turning over; the middle section is
// clamped, where by symmetry the exact loop needs no force.
#pragma once

#include <algorithm>
#include <cmath>

#include "cubic.h"
#include "resampler.h"
#include "rod_static.h"
#include "sampling.h"
#include "unit/thread/rod_builder.h"

namespace sutura::thread::loop {

constexpr Real length = 0.3, middle = length / 2;
constexpr Real tight = 2e-3;  ///< l of the loop asked for: radius l/2 = 1 mm

/// A braid, size 4-0: its extension and shear are 2e-5 in the tightest loop.
inline Section braid() {
  return {
      .radius = 0.0875e-3, .young = 1.5e9, .poisson = 0.4, .density = 910, .bending_factor = 0.05};
}
inline Pose rest(Real s) {
  return {Vec3(s, 0, 0), Quat::Identity()};
}
inline Real tension(Real l) {
  return braid().bending_stiffness() / (l * l);
}

/// Section of the exact loop, apex at the origin.
inline Pose pose(Real s, Real l) {
  const Real u = (s - middle) / l;
  return {Vec3(s - middle - 2 * l * std::tanh(u), 2 * l * (1 / std::cosh(u) - 1), 0),
          Quat(Eigen::AngleAxis<Real>(4 * std::atan(std::exp(u)), Vec3::UnitZ()))};
}

/// Extension and shear push the ends apart by this, to first order: minus the derivative with
/// respect to T of the complementary energy T^2/2 (c (L - 8 l/3) + g 8 l/3), integrals of cos^2 and
/// sin^2 of theta. T c = 2e-5, so the second order is below 1e-9 of L.
inline Real stretch(Real l) {
  const Real c = 1 / braid().axial_stiffness(), g = 1 / braid().shear_stiffness(), T = tension(l);
  return T * c * length + 2 * (g - c) * T * l;
}

inline Index middle_node(const Rod& rod) {
  const auto& a = rod.abscissa();
  return std::lower_bound(a.begin(), a.end(), middle - 1e-9) - a.begin();
}

/// Uniform beams (an even number) laid along the exact loop, middle clamped.
inline Rod laid_out(Index beams, Real l) {
  RodLayout layout = straight_layout(length, beams, braid());
  for (std::size_t i = 0; i < layout.start.size(); ++i)
    layout.start[i] = pose(layout.abscissa[i], l);
  Rod rod;
  rod.build(layout);
  rod.clamp(beams / 2);
  return rod;
}

/// Equilibrium with both ends pulled by T = EI/l^2.
inline bool pull(Rod& rod, Real l, int* iterations = nullptr) {
  VecX load = VecX::Zero(rod.dofs());
  load[0] = -tension(l);
  load[6 * rod.nodes() - 6] = tension(l);
  // Rounding of EA leaves 1e-13 N; 1e-8 of the tension of the tight loop, whose shortening goes
  // with its root.
  const auto report = equilibrium(rod, Vec3::Zero(), load, 1e-8 * tension(tight));
  if (iterations) *iterations += report.iterations;
  return report.converged;
}

/// Both ends held and moved so that the exact loop of this l fits between them.
inline void hold_ends(Rod& rod, Real l) {
  rod.springs().resize(2);
  for (const int end : {0, 1}) {
    NodeSpring& spring = rod.springs()[static_cast<std::size_t>(end)];
    spring.active = true;
    spring.node = end * rod.beams();
    spring.stiffness = {.translation = 1e5, .rotation = 1};
    spring.target = pose(end * length, l);
    spring.target.position.x() += (2 * end - 1) * stretch(l) / 2;
  }
}

inline bool resample(Rod& rod, const SamplingRules& rules, SamplingWork& work) {
  if (!sample(rod, rules, work)) return false;
  Resampler().apply(rod, work.nodes, rest, [](Real) { return braid(); });
  return true;
}

inline SamplingRules rules(Real angle) {
  return {.angle = angle, .shortest = 0.05e-3, .longest = 20e-3, .forced = {middle}};
}

/// A wide loop (16 mm) of 64 beams pulled tight in 20 steps, sampled until nothing changes in each.
/// False if some equilibrium or some sampling did not settle.
inline bool pull_tight(Rod& rod, Real angle) {
  const Real wide = 16 * tight;
  rod = laid_out(64, wide);
  SamplingWork work;
  constexpr int steps = 20;
  for (int k = 0; k <= steps; ++k) {
    const Real l = wide * std::pow(tight / wide, static_cast<Real>(k) / steps);
    int events = 0;
    for (bool changed = true; changed; ++events) {
      if (events == 20 || !pull(rod, l)) return false;
      changed = resample(rod, rules(angle), work);
    }
  }
  return true;
}

/// Relative to the exact loop. Height: moment in the middle over T. Curvature: of the cubics that
/// meet there.
struct Errors {
  Real shortening = 0, height = 0, curvature = 0;
  bool below(const Errors& o) const {
    return shortening < o.shortening && height < o.height && curvature < o.curvature;
  }
};

inline Errors errors(const Rod& rod, Real l) {
  const auto& p = rod.poses(Configuration::current);
  const Index apex = middle_node(rod);
  const Real shortening = length + stretch(l) - (p.back().position - p.front().position).x();
  ElementState state;
  rod.element_state(apex, state);
  const Real moment = gradient(rod.element(apex), state).a.norm();
  const auto curvature = [&](Index beam, Real u) {
    const Cubic cubic(p[beam], p[beam + 1], rod.element(beam).length);
    const Vec3 slope = cubic.slope(u);
    return slope.cross(cubic.second(u)).norm() / std::pow(slope.norm(), 3);
  };
  const auto off = [](Real value, Real exact) { return std::abs(value / exact - 1); };
  return {off(shortening, 4 * l), off(moment, tension(l) * 2 * l),
          off((curvature(apex - 1, 1) + curvature(apex, 0)) / 2, 2 / l)};
}

}  // namespace sutura::thread::loop
