// What single splits and merges of a straight nylon thread do to energy and momentum.
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>

#include "resampler.h"
#include "rod_builder.h"
#include "sampling.h"

namespace sutura::thread {

inline Pose rest_pose(Real s) {
  return {Vec3(s, 0, 0), Quat::Identity()};
}
inline Section section(Real) {
  return nylon();
}

struct BeamEnergy {
  Real elastic = 0, bending = 0;  ///< J; bending: all but that of the strain

  /// Of the beams between two abscissae that are nodes.
  BeamEnergy(const Rod& rod, Real from, Real to) {
    ElementState state;
    for (Index e = 0; e < rod.beams(); ++e) {
      if (rod.abscissa()[e] < from - 1e-12 || rod.abscissa()[e + 1] > to + 1e-12) continue;
      rod.element_state(e, state);
      const Real u = elastic_energy(rod.element(e), state);
      elastic += u;
      bending += u - rod.element(e).axial * rod.element(e).length * state.strain * state.strain / 2;
    }
  }
};

/// Largest changes over events: of elastic energy over the bending energy of the beams concerned,
/// of the kinetic energy and the momenta of the rod over themselves.
struct Jumps {
  Real split = 0, merge = 0, kinetic = 0, momentum = 0, angular_momentum = 0;
  int events = 0, splits = 0, merges = 0;
  std::string text() const {
    char line[200];
    std::snprintf(line, sizeof line,
                  "%d events; %d splits, largest jump %.1e; %d merges, %.1e; kinetic energy %.1e, "
                  "momenta %.1e and %.1e",
                  events, splits, split, merges, merge, kinetic, momentum, angular_momentum);
    return line;
  }
};

/// Resamples once and adds every split and merge, each by itself, to the list.
inline bool resample_and_compare(Rod& rod, const SamplingRules& rules, Jumps& jumps) {
  SamplingWork work;
  if (!sample(rod, rules, work)) return false;
  const Rod before = rod;
  Resampler().apply(rod, work.nodes, rest_pose, section);
  ++jumps.events;
  // Beams far from any bend carry less than 1e-6 of the energy: no jump there matters.
  const Real least = 1e-6 * before.elastic_energy();
  const auto compare = [&](const Rod& whole, const Rod& halves, Real& largest, int& count) {
    const auto& a = whole.abscissa();
    for (Index e = 0; e < whole.beams(); ++e) {
      const auto& b = halves.abscissa();
      const auto inside = std::upper_bound(b.begin(), b.end(), a[e] + 1e-12);
      if (inside == b.end() || *inside > a[e + 1] - 1e-12) continue;
      const BeamEnergy was(before, a[e], a[e + 1]), now(rod, a[e], a[e + 1]);
      if (was.bending < least) continue;
      ++count;
      largest = std::max(largest, std::abs(now.elastic - was.elastic) / was.bending);
    }
  };
  compare(before, rod, jumps.split, jumps.splits);
  compare(rod, before, jumps.merge, jumps.merges);
  const auto note = [](Real& largest, Real change, Real of) {
    if (of > 0) largest = std::max(largest, std::abs(change) / of);
  };
  note(jumps.kinetic, rod.kinetic_energy() - before.kinetic_energy(), before.kinetic_energy());
  note(jumps.momentum, (rod.momentum() - before.momentum()).norm(), before.momentum().norm());
  note(jumps.angular_momentum, (rod.angular_momentum() - before.angular_momentum()).norm(),
       before.angular_momentum().norm());
  return true;
}

}  // namespace sutura::thread
