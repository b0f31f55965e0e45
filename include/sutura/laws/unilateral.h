// Unilateral: two things must not pass each other; a thread must not grow longer.
//
//   0 <= delta + c lambda   _|_   lambda >= 0          (Signorini)
//
// delta (m) distance, lambda (N) force that pushes apart, c (m/N) compliance of the contact itself:
// where many contacts say the same W is singular, and only c makes the forces unique (of a rope,
// its cross section gives about 1 / (E d)). With delta = rest length (1 + strain) - arc length the
// same law is the limit of elongation.
#pragma once

#include "sutura/law.h"

namespace sutura {

struct Unilateral {
  static constexpr int dim = 1;
  static constexpr const char* name = "unilateral";
  struct Params {
    Real compliance = 0;  ///< c, m/N
  };
  static constexpr Mode open = 0;
  static constexpr Mode closed = 1;

  static void project(const BlockMatrix<1>& W, const BlockVector<1>& d, const Params& p, Mode& mode,
                      BlockVector<1>& lambda) {
    const Real w = W(0, 0) + p.compliance;
    lambda[0] = d[0] < 0 && w > 0 ? -d[0] / w : Real(0);
    mode = d[0] < 0 ? closed : open;
  }

  static void free_directions(const BlockVector<1>&, const Params& p, Mode mode,
                              const BlockVector<1>& lambda, FreeDirections<1>& free) {
    free.count = mode == closed ? 1 : 0;
    free.gap[0] = p.compliance * lambda[0];
    free.compliance(0, 0) = p.compliance;
  }
};

}  // namespace sutura
