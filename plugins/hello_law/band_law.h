// Elastic band with a limited force: the law of one row.
//
//   delta   how far the band is from being stretched (m): minus the stretch, positive while slack
//   lambda  its tension (N)
//
//   slack     delta >= 0          lambda = 0
//   taut      delta = -lambda/k   0 <= lambda <= limit
//   yielding  delta <= -limit/k   lambda = limit       (the hand that holds it follows)
#pragma once

#include <algorithm>

#include "sutura/law.h"

struct BandLaw {
  static constexpr int dim = 1;
  static constexpr const char* name = "band";
  struct Params {
    sutura::Real stiffness = 1;  ///< k, N/m
    sutura::Real limit = 1;      ///< N
  };
  static constexpr sutura::Mode slack = 0, taut = 1, yielding = 2;

  // delta = W lambda + d, and taut: W lambda + d = -lambda / k. Clamping is exact for one row,
  // because delta grows with lambda.
  static void project(const sutura::BlockMatrix<1>& W, const sutura::BlockVector<1>& d,
                      const Params& p, sutura::Mode& mode, sutura::BlockVector<1>& lambda) {
    const sutura::Real tension = -d[0] / (W(0, 0) + 1 / p.stiffness);
    lambda[0] = std::clamp(tension, sutura::Real(0), p.limit);
    mode = tension <= 0 ? slack : tension < p.limit ? taut : yielding;
  }

  // The tangent of the graph, for the solver's direct step: a spring while taut, else nothing free.
  static void free_directions(const sutura::BlockVector<1>&, const Params& p, sutura::Mode mode,
                              const sutura::BlockVector<1>& lambda,
                              sutura::FreeDirections<1>& free) {
    free.count = mode == taut ? 1 : 0;
    free.gap[0] = lambda[0] / p.stiffness;
    free.compliance(0, 0) = 1 / p.stiffness;
  }
};
