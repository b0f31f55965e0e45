// A mesh that is fit to compute with, and all that depends on nothing else.
#pragma once

#include <memory>

#include "block_matrix.h"
#include "mesh_check.h"
#include "mesh_data.h"
#include "solid_queries.h"

namespace sutura {
class Cache;
}

namespace sutura::tissue {

/// Immutable, shared by the simulations that have the same mesh.
struct RestShape {
  MeshData mesh;
  CheckedMesh checked;
  std::shared_ptr<const SolidTopology> topology;  ///< null if the mesh cannot be used
};

/// As check_mesh. One that is in the cache (may be null) has been made from the same bits.
std::shared_ptr<const RestShape> rest_shape(MeshData mesh, bool assumed_metres, Cache* cache);

}  // namespace sutura::tissue
