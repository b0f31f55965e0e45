// What a link means: a path, or the only component of its type in reach.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "scene/reader.h"

namespace sutura {

/// Resolves every link in order. Targets whose path is in `failed` are not complained of again.
void resolve_links(Scene& scene, const Registry& registry, const std::vector<PendingLink>& links,
                   const std::set<std::string>& failed, Diagnostics& diagnostics);

/// A component is initialised after those it links to: a ring of links is an error.
void check_rings(const Scene& scene, Diagnostics& diagnostics);

}  // namespace sutura
