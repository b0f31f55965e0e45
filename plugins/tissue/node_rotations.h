// How far the material around each node has turned since rest.
#pragma once

#include <vector>

#include "mesh_data.h"

namespace sutura::tissue {

/// Per node: the rotation of the mean deformation of its tets, each in proportion to its volume.
void node_rotations(const MeshData& mesh, const VecX& x, std::vector<Mat3>& rotations);

}  // namespace sutura::tissue
