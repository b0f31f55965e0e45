// Rows that repeat or contradict each other.
//
// Strands that lie along each other touch in many places at once, and a knot couples more touches
// than the thread between them can tell apart: W is singular, forces that cancel each other are
// free, and two linearised gaps may ask for the impossible. Sweeps and direct steps then never end.
// So blocks of this kind may give way a little in a pass,
//
//   delta = W lambda + d_free + R (lambda - lambda_before),   R = share * the block's own W,
//
// which makes the answer unique. The next pass begins from these forces: what R let go is taken
// back then, and where the passes end lambda = lambda_before, and R is gone. This is the proximal
// point method (R. T. Rockafellar, SIAM J. Control Optim. 14, 1976), with the passes of the step as
// its iterations.
#pragma once

#include "sutura/constraints.h"

namespace sutura {

/// W and d_free of the redundant blocks, for forces that are near the present lambda.
void soften_redundant_rows(ConstraintProblem& problem);

}  // namespace sutura
