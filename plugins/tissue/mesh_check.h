// Makes a mesh fit to compute with, and says what was odd about it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mesh_data.h"

namespace sutura::tissue {

/// A triangle of the boundary, counterclockwise seen from outside, and the tet behind it.
struct BoundaryFace {
  Triangle nodes{};
  Index tet = -1;
};

struct MeshReport {
  Index reoriented = 0;    ///< tets whose nodes were listed in the opposite sense
  Index unused_nodes = 0;  ///< removed
  /// Nodes at the very place of another one, but for those of cuts: the mesh may come apart there.
  Index duplicate_nodes = 0;
  Index hanging_nodes =
      0;                   ///< of the boundary, within a triangle of it of which they are no corner
  Index parts = 0;         ///< pieces that share no face, edge or node
  Index slivers = 0;       ///< tets of quality below 0.05
  Real worst_quality = 1;  ///< 6 sqrt(2) V / (rms edge)^3: 1 for the regular tet, 0 for a flat one
  Index worst_tet = -1;
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  ///< bounding box (m)
  std::vector<std::string> warnings;             ///< one sentence each
};

struct CheckedMesh {
  MeshReport report;
  std::vector<BoundaryFace> boundary;
  std::string error;  ///< a sentence if the mesh cannot be used: flat tets, overlapping tets
};

/// Reorders the nodes of tets so that every signed volume is positive, removes unused nodes, finds
/// the boundary. `assumed_metres`: no unit was given, so guess whether millimetres were meant.
CheckedMesh check_mesh(MeshData& mesh, bool assumed_metres);

/// Of every node, the first node of the piece that it belongs to (see MeshReport::parts).
std::vector<Index> first_of_part(const MeshData& mesh);

}  // namespace sutura::tissue
