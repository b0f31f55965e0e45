// modelDescription.xml of an FMU.
#pragma once

#include <string>

#include "sutura/simulation.h"

namespace sutura::app {

/// Letters, digits and underscores, as the name of a function in C.
std::string model_identifier(const std::string& name);

/// Variables in the order in which src/fmu/instance.h numbers them.
std::string model_description(const Simulation& simulation, const std::string& name);

}  // namespace sutura::app
