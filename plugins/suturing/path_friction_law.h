// Path friction: a thread or needle slides through its path in the tissue, and drags on it.
//
//   sticking:   |lambda| <= Rs,  delta = 0
//   slipping:   lambda = -sign(delta) (Rk + c |delta|)
//
// One row along the path: delta (m) displacement of the thread relative to the tissue over the
// step, lambda (N) the drag on the thread. Rs, Rk (N) static and kinetic level of the length l that
// the sample stands for (l pi d mu p); c = l pi d alpha / dt (N/m) viscous part, since
// delta / dt is the speed. Closed form for one block: with stick candidate -d / w,
//   |d| <= w R: lambda = -d / w,   else |delta| = (|d| - w R) / (1 + w c), lambda = -sign(d) (R + c |delta|),
// unique for w > 0, c >= 0 (algorithms.md B.6).
//
// Static above kinetic makes the law ambiguous between Rk and Rs, and the drop from Rs to Rk at
// break-away irreversible within a step. So each regime keeps one level, both are monotone (the
// solution does not depend on sweeps or order), and break-away is an event: only on converged
// forces, when a sample at its static limit slips by more than `band` (Karnopp's velocity band times
// dt: slower is not sliding). The way back: in the kinetic regime a sample that comes to rest is
// `held` with at most Rk; the source starts it in `stick` next step, as it does for a slip below `band`.
#pragma once

#include <cmath>

#include "sutura/law.h"

namespace sutura {

struct PathFrictionLaw {
  static constexpr int dim = 1;
  static constexpr const char* name = "path_friction";
  struct Params {
    Real static_level = 0;   ///< Rs, N
    Real kinetic_level = 0;  ///< Rk, N, at most Rs
    Real viscosity = 0;      ///< c, N/m
    Real band = 0;           ///< m
  };
  static constexpr Mode stick = 0;
  static constexpr Mode slip_forward = 1;    ///< delta > 0
  static constexpr Mode slip_backward = 2;   ///< delta < 0
  static constexpr Mode yield_forward = 3;   ///< at the static limit, slip not beyond the band
  static constexpr Mode yield_backward = 4;
  static constexpr Mode held = 5;            ///< kinetic regime, at rest
  static bool is_static(Mode m) { return m == stick || m == yield_forward || m == yield_backward; }

  /// In which mode the next step starts, from the mode and delta of this one.
  static Mode next_mode(const Params& p, Mode mode, Real delta) {
    if (is_static(mode) || mode == held || std::abs(delta) <= p.band) return stick;
    return mode;
  }

  static void project(const BlockMatrix<1>& W, const BlockVector<1>& d, const Params& p, Mode& mode,
                      BlockVector<1>& lambda) {
    const bool is_stick = is_static(mode);
    const Real level = is_stick ? p.static_level : p.kinetic_level;
    const Real w = W(0, 0), size = std::abs(d[0]);
    if (size <= w * level) {
      lambda[0] = w > 0 ? -d[0] / w : Real(0);
      mode = is_stick ? stick : held;
      return;
    }
    const Real slip = (size - w * level) / (1 + w * p.viscosity);
    const Real force = level + p.viscosity * slip;
    const bool forward = d[0] > 0;
    lambda[0] = forward ? -force : force;
    mode = is_stick ? (forward ? yield_forward : yield_backward)
                    : (forward ? slip_forward : slip_backward);
  }

  static void free_directions(const BlockVector<1>&, const Params& p, Mode mode,
                              const BlockVector<1>& lambda, FreeDirections<1>& out) {
    out.count = 1;
    if (mode == stick || mode == held) return;
    if (p.viscosity <= 0) {
      out.count = 0;
      return;
    }
    // lambda = -+ (R) - c delta: a spring of compliance 1 / c about the level.
    const Real level = is_static(mode) ? p.static_level : p.kinetic_level;
    const bool forward = mode == slip_forward || mode == yield_forward;
    out.gap[0] = (lambda[0] + (forward ? level : -level)) / p.viscosity;
    out.compliance(0, 0) = 1 / p.viscosity;
  }

  static bool event(const Params& p, const BlockVector<1>& delta, Mode& mode,
                    const BlockVector<1>&) {
    if ((mode != yield_forward && mode != yield_backward) || std::abs(delta[0]) <= p.band)
      return false;
    mode = mode == yield_forward ? slip_forward : slip_backward;
    return true;
  }
};

}  // namespace sutura
