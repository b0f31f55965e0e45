// A rod at rest: static equilibrium under gravity and dead loads.
#pragma once

#include "block_tridiagonal.h"
#include "rod.h"

namespace sutura::thread {

struct StaticReport {
  bool converged = false;
  int iterations = 0;
  Real residual = 0;  ///< N, largest force (moments divided by the mean beam length)
};

/// Moves the rod to where gravity and dead loads on its nodes (N, N m; 6 per node) are balanced, by
/// Newton with the full tangent, in 20 load steps where one is too many. Springs act as in a step;
/// the velocity becomes zero. Converged: the residual is at most `tolerance` (N).
StaticReport equilibrium(Rod& rod, const Vec3& gravity, const VecX& load, Real tolerance = 1e-10,
                         int max_iterations = 200);

/// The derivative of the static balance at the present state: stiffness of beams, springs and
/// weight, clamps applied. `tension` (N, per beam) replaces that of the beams.
void assemble_static(const Rod& rod, const Vec3& gravity, BlockTridiagonal& matrix,
                     const std::vector<Real>* tension = nullptr);

}  // namespace sutura::thread
