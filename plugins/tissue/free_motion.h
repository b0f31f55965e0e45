// How a tissue could move as a rigid body although it is attached.
#pragma once

#include <string>

#include "tissue_model.h"

namespace sutura::tissue {

/// The first part of the mesh that attachments let move without being deformed, and how, a
/// sentence; empty if they hold every part.
std::string free_motion(const TissueModel& model);

}  // namespace sutura::tissue
