// Bodies whose W is approximate: how far is what lambda does from what W said?
#pragma once

#include <span>

#include "sutura/constraints.h"

namespace sutura {

/// error = d_free + h^2 sum H A^-1 H^T lambda - delta, per row, with A^-1 by Body::solve; delta as
/// the solver left it. Returns the largest entry (m).
Real compliance_error(std::span<const Body* const> bodies, const ConstraintProblem& problem,
                      const VecX& d_free, Real dt, VecX& error);

}  // namespace sutura
