// The potential of a rod's step (incremental potential of implicit Euler): the step ends at its
// minimum.
#pragma once

#include "rod_guess.h"

namespace sutura::thread {

/// At the guess (J): elastic energy and weight, springs, what drag and viscosity take, half the
/// squared change of velocity in the norm of the mass, less the work of loads and of the
/// constraints of the last pass. Its derivative by the motion is minus what is missing of momentum,
/// per time.
Real potential(const Rod& rod, const RodStart& start, const RodGuess& guess);

}  // namespace sutura::thread
