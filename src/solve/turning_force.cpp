#include "sutura/laws/turning_force.h"

namespace sutura {

BlockMatrix<2> TurningForce::compliance(const Params& p) {
  BlockMatrix<2> c;
  c << 0, 1 / p.coupling, 1 / p.coupling, -p.stiffness / (p.coupling * p.coupling);
  return c;
}

void TurningForce::project(const BlockMatrix<2>& W, const BlockVector<2>& d, const Params& p,
                           Mode& mode, BlockVector<2>& lambda) {
  if (mode == whole) {
    const BlockMatrix<2> m = W + compliance(p);
    const Real determinant = m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
    lambda = BlockVector<2>(m(0, 1) * d[1] - m(1, 1) * d[0], m(1, 0) * d[0] - m(0, 0) * d[1]) /
             determinant;
    if (lambda.allFinite()) return;
  }
  mode = spring;
  lambda.setZero();
  if (p.stiffness > 0) lambda[0] = -p.stiffness * d[0] / (p.stiffness * W(0, 0) + 1);
}

void TurningForce::free_directions(const BlockVector<2>&, const Params& p, Mode mode,
                                   const BlockVector<2>& lambda, FreeDirections<2>& free) {
  free.count = 2;
  if (mode == whole) {
    free.compliance = compliance(p);
    free.gap = free.compliance * lambda;
    return;
  }
  free.count = p.stiffness > 0 ? 1 : 0;
  free.compliance(0, 0) = 1 / p.stiffness;
  free.gap[0] = lambda[0] / p.stiffness;
}

}  // namespace sutura
