// How a rod moves as a whole.
#pragma once

#include "rod.h"

namespace sutura::thread {

/// The velocity of a rod as a rigid body as a step of `dt` begins (6 per node; m/s, rad/s): that of
/// the holds or, where there are none, that of its momentum. Zero where these do not move as one
/// body. Zero also unless the rod pushes itself alone, that is, the forces of constraints (N, N m)
/// have no sum: it is against what pushes it that it moves or not.
void find_common_motion(const Rod& rod, const Dofs& force, Real dt, DofVector& velocity);

}  // namespace sutura::thread
