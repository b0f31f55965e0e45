// Where the nodes of a rod should be: dense where it bends, coarse where it is straight.
//
// A beam is split when its turning angle, the integral of |dt/ds| along its cubic (an S does not
// count as straight), exceeds `angle`, now or at rest; two beams are merged when the merged one
// would stay below half of it (hysteresis: no flicker) and keeps their energy. Lengths stay between
// `shortest` and `longest`, neighbours within a factor of two. One level per call.
//
// Bends at rest count as well: a beam knows its rest shape to the fourth power of its turn, and a
// whole and its halves differ by that in what they take for unstrained.
#pragma once

#include "rod.h"

namespace sutura::thread {

struct SamplingRules {
  Real angle = 0.3;               ///< rad
  Real shortest = 0;              ///< m
  Real longest = 1;               ///< m
  Real from = 0;                  ///< beams before this abscissa are left alone (needle), m
  std::vector<Real> forced = {};  ///< abscissae that stay nodes (holds, swage), m
};

/// Integral of |dt/ds| along a beam (rad).
Real turning_angle(const Rod& rod, Index beam, Configuration c = Configuration::current);

/// Work space of sample(), kept by the caller so that a quiet step allocates nothing.
struct SamplingWork {
  std::vector<Real> nodes;  ///< the nodes asked for, m
  std::vector<Real> angle;  ///< per beam, rad
  std::vector<char> split;  ///< per beam
  void reserve(std::size_t beams);
};

/// Puts the nodes the rules ask for into `work.nodes`; true when they differ from the rod's.
bool sample(const Rod& rod, const SamplingRules& rules, SamplingWork& work);
/// The same with a work space of its own.
std::vector<Real> sample(const Rod& rod, const SamplingRules& rules, bool& changed);

}  // namespace sutura::thread
