// Cutting: the tip meets the end of its own path.
//
//   lambda = clamp(-d / w, 0, fc)
//
// One row along the shaft, or along the surface that holds the tip from inside: delta (m) =
// recorded end of the path minus the tip, positive while the tip is behind the end; lambda (N)
// pushes the tip back. Behind the end: no force (re-insertion along an old path is free). At the
// end: as much as it takes, up to fc. Beyond (delta < 0, lambda = fc): the tip cuts, and the source
// moves the end by -delta in commit. The law needs no event: a cut is recorded after the step, from
// the converged delta. Source: as of puncture_law.h, 4.3.
#pragma once

#include <algorithm>

#include "sutura/law.h"

namespace sutura::suturing {

struct CuttingLaw {
  static constexpr int dim = 1;
  static constexpr const char* name = "cutting";
  struct Params {
    Real threshold = 0;  ///< fc, N
  };
  static constexpr Mode behind = 0;
  static constexpr Mode stopped = 1;
  static constexpr Mode cutting = 2;

  static void project(const BlockMatrix<1>& W, const BlockVector<1>& d, const Params& p, Mode& mode,
                      BlockVector<1>& lambda) {
    if (d[0] >= 0) {
      lambda[0] = 0;
      mode = behind;
    } else if (-d[0] <= W(0, 0) * p.threshold) {
      lambda[0] = -d[0] / W(0, 0);
      mode = stopped;
    } else {
      lambda[0] = p.threshold;
      mode = cutting;
    }
  }

  static void free_directions(const BlockVector<1>&, const Params&, Mode mode,
                              const BlockVector<1>&, FreeDirections<1>& out) {
    out.count = mode == stopped ? 1 : 0;
  }
};

}  // namespace sutura::suturing
