// Path friction: a thread or needle slides through its path in the tissue, and drags on it.
//
//   sticking:   |lambda| <= Rs,  delta = 0
//   slipping:   lambda = -sign(delta) (Rk + c |delta|)
//
// One row along the path: delta (m) displacement of the thread relative to the tissue over the
// step, lambda (N) the drag on the thread. Rs, Rk (N) static and kinetic level of the length l that
// the sample stands for (l pi d mu p); c = l pi d alpha / dt (N/m) viscous part, since
// delta / dt is the speed. Closed form for one block: with stick candidate -d / w,
//   |d| <= w R: lambda = -d / w,   else |delta| = (|d| - w R) / (1 + w c), lambda = -sign(d) (R + c
//   |delta|),
// unique for w > 0, c >= 0.
//
// Between Rk and Rs both rest and slip would be answers. So each mode has one level and is monotone
// (the solution does not depend on sweeps or order), and break-away, from `stick` to `slip`, is an
// event: it happens on verified forces only, when a sample at its static limit slips by more than
// `stick_slip` (Karnopp's velocity band times dt: slower is not sliding). The way back is between
// steps: a sample that slipped by less than that begins the next step in `stick`. In the mode
// `slip` a sample may come to rest, then delta = 0 with at most Rk. Where Rs = Rk both modes are
// the same law, and no event is needed.
#pragma once

#include <cmath>

#include "sutura/law.h"

namespace sutura::suturing {

struct PathFrictionLaw {
  static constexpr int dim = 1;
  static constexpr const char* name = "path_friction";
  struct Params {
    Real static_level = 0;  ///< Rs, N
    Real kinetic = 0;       ///< Rk, N, at most Rs
    Real viscous = 0;       ///< c, N/m
    Real stick_slip = 0;    ///< m
  };
  static constexpr Mode stick = 0;
  static constexpr Mode slip = 1;

  static void project(const BlockMatrix<1>& W, const BlockVector<1>& d, const Params& p, Mode& mode,
                      BlockVector<1>& lambda) {
    const Real limit = level(p, mode), w = W(0, 0), size = std::abs(d[0]);
    if (size <= w * limit) {
      lambda[0] = w > 0 ? -d[0] / w : Real(0);
      return;
    }
    const Real slipped = (size - w * limit) / (1 + w * p.viscous);
    lambda[0] = std::copysign(limit + p.viscous * slipped, -d[0]);
  }

  static void free_directions(const BlockVector<1>&, const Params& p, Mode mode,
                              const BlockVector<1>& lambda, FreeDirections<1>& out) {
    const Real limit = level(p, mode);
    out.count = 1;
    if (std::abs(lambda[0]) < limit) return;
    if (!(p.viscous > 0)) {
      out.count = 0;
      return;
    }
    // lambda = -+ R - c delta: a spring of compliance 1 / c about the level.
    out.gap[0] = (lambda[0] - std::copysign(limit, lambda[0])) / p.viscous;
    out.compliance(0, 0) = 1 / p.viscous;
  }

  /// The force is as large as the mode allows: the sample may slide.
  static bool at_limit(const Params& p, Mode mode, Real lambda) {
    constexpr Real rounding = 1e-9;  // of a force that was found as a sum of changes
    return std::abs(lambda) >= (1 - rounding) * level(p, mode);
  }

  static bool event(const Params& p, const BlockVector<1>& delta, Mode& mode,
                    const BlockVector<1>& lambda) {
    const bool breaks_away = mode == stick && p.kinetic < p.static_level &&
                             at_limit(p, mode, lambda[0]) && std::abs(delta[0]) > p.stick_slip;
    if (breaks_away) mode = slip;
    return breaks_away;
  }

  static Mode next_mode(const Params& p, const BlockVector<1>& delta, Mode mode,
                        const BlockVector<1>&) {
    return mode == slip && std::abs(delta[0]) > p.stick_slip ? slip : stick;
  }

 private:
  static Real level(const Params& p, Mode mode) {
    return mode == stick ? p.static_level : p.kinetic;
  }
};

}  // namespace sutura::suturing
