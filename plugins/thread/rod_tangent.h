// The matrix of a rod's step, A = M + h B + h^2 K, at a guess: minus the derivative of the balance
// (rod_guess.h) by the velocity at the end of the step.
#pragma once

#include "block_tridiagonal.h"
#include "rod_guess.h"

namespace sutura::thread {

/// What stands for K.
///   exact: the Hessian of the energy, which may be indefinite.
///   convex: its positive semidefinite part (`step_stiffness` in element.h).
/// Both take the predicted tension of the guess: stretch that a turn faked is not to stiffen a beam
/// (docs/theory/thread.md). Of viscosity, the geometric part of its
/// moments is left out; that of its compression is in the exact one.
enum class Tangent { exact, convex };

void assemble(const Rod& rod, const RodStart& start, const RodGuess& guess, Tangent tangent,
              BlockTridiagonal& matrix);
/// Between the two: of the convex one this share, of the exact one the rest.
void assemble(const Rod& rod, const RodStart& start, const RodGuess& guess, Real convex,
              BlockTridiagonal& matrix);

/// Factors what `assemble` made; false if that is not positive definite.
bool factor(BlockTridiagonal& matrix);

}  // namespace sutura::thread
