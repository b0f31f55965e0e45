// What a saved state must agree with before it is restored.
#pragma once

#include <string>

#include "sutura/scene.h"

namespace sutura {

/// Text that differs if the scene differs, one of the files it names, or the build. Where results
/// are written and how long the run takes do not count.
std::string identity_of(const Scene& scene);

}  // namespace sutura
