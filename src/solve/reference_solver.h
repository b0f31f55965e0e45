// The accuracy reference: ADMM finds the modes, Newton over the laws' tangents finishes. Slower
// than Gauss-Seidel on most problems of a step, and independent of it: no sweep, no order.
//
// ADMM (Boyd et al. 2011, section 3; for friction Acary, Bremond, Huber 2018) alternates between
// the system and the laws:
//   x <- (W + P)^-1 (P z + s - d_free)
//   (z, s) <- each block's law with W replaced by P:  s = P z + (s - P x)
// with P = rho * (mean diagonal of the block of W) * identity, the same in all directions of a
// block. At rest x = z and s = W z + d_free. rho is adapted to the balance of the two residuals.
#pragma once

#include <Eigen/Cholesky>

#include "solve/law_residual.h"
#include "solve/subspace_step.h"
#include "sutura/constraints.h"

namespace sutura {

struct ReferenceOptions {
  Real tolerance = 1e-8;    ///< of the law residual
  Index iterations = 4000;  ///< budget of ADMM
  bool newton = true;
};

class ReferenceSolver {
 public:
  explicit ReferenceSolver(ReferenceOptions options = {}) : options_(options) {}
  SolveReport solve(ConstraintProblem& problem);  ///< `sweeps` counts ADMM iterations

 private:
  void set_rho(Real rho);
  /// Iterates at most `count` times or until the law residual falls below `target`.
  Residual admm(ConstraintProblem& problem, Index count, Real target, Index& iterations);

  ReferenceOptions options_;
  Compliance compliance_;
  MatX W_;  // of all bodies
  SubspaceStep subspace_;
  Eigen::LLT<MatX> factor_;
  Real rho_ = 0;
  VecX weight_, penalty_;  // mean diagonal of each row's block; rho times it
  VecX x_, s_;
  GrowingVec lambda_plus_;
};

}  // namespace sutura
