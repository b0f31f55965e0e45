// Opens a mesh along faces of its elements: two walls that lie on each other, without a gap.
#pragma once

#include <functional>

#include "mesh_data.h"

namespace sutura::tissue {

/// Opens each face between two tets that `is_cut` says yes to, given its three corners. A node gets
/// a copy for every further part into which its tets come apart; at the end of a cut they hang
/// together around it, and it stays one. Returns the number of faces.
Index cut_open(MeshData& mesh, const std::function<bool(const std::array<Vec3, 3>&)>& is_cut);

}  // namespace sutura::tissue
