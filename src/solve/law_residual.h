// How far a problem is from its laws: the natural map. For every block, lambda_plus is what its law
// answers to the present delta; a solution has lambda_plus = lambda. Measured in the units of each
// block, as a force and as a length.
//
// A law may be asked with any positive definite compliance. It is asked with the diagonal of the
// block's own, which leaves it one answer. Where friction lifts a touch by more than its normal
// force presses it (mu |W_nt| > W_nn), the whole of W leaves it two, stick and slip: asked with it
// at a solution that slips, the law may say stick, and what is solved would never count as solved.
#pragma once

#include <vector>

#include "solve/compliance.h"
#include "sutura/constraints.h"

namespace sutura {

struct Residual {
  Real value = 0;      ///< largest over the blocks, in their units
  Real violation = 0;  ///< largest D |lambda_plus - lambda|, D the diagonal of W_cc, m
  /// Asks the law of one block at the present lambda and delta; counts what it would change and
  /// notes the violation. W: the block's own, dim x dim. Returns the block's own residual.
  Real ask(const ConstraintProblem& problem, ConstraintBlock& block, const Real* W, Mode& mode,
           Real* lambda_plus);
};

/// Asks every law with the present lambda and delta; lambda is left alone. `per_block`, if given,
/// receives the residual of each block.
Residual natural_map(ConstraintProblem& problem, const Compliance& compliance,
                     GrowingVec& lambda_plus, std::vector<Real>* per_block = nullptr);

/// Fires what is due, all at once; returns how many.
Index fire_events(ConstraintProblem& problem);

/// Is one due of a block that asks for its time?
bool timed_event_is_due(const ConstraintProblem& problem);

/// Events wait for forces that are converged at least this well (in units of the
/// blocks): fired on transient forces they end in wrong states.
inline constexpr Real event_gate = 1e-3;

/// d = delta - W_cc lambda of one block.
inline void own_free_violation(int dim, const Real* W, const Real* delta, const Real* lambda,
                               Real* d) {
  for (int i = 0; i < dim; ++i) {
    Real own = 0;
    for (int j = 0; j < dim; ++j) own += W[i + j * dim] * lambda[j];
    d[i] = delta[i] - own;
  }
}

}  // namespace sutura
