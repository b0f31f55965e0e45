// Balance without motion: where a tissue comes to rest under its weight and loads.
#pragma once

#include <string>

#include "tissue_model.h"

namespace sutura::tissue {

/// Moves x, of a tissue that something holds, to the nearest balance. `load`: N, three numbers per
/// node; followers change it. Returns what it could not do, as a sentence; empty if it found the
/// balance.
std::string settle(TissueModel& model, VecX& load, const Vec3& gravity, VecX& x);

}  // namespace sutura::tissue
