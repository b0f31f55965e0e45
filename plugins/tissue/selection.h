// Which part of a tissue a component speaks of: a box at rest, a region of the mesh, or what both
// have in common.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tet_mesh.h"

namespace sutura::tissue {

/// An axis-parallel box, a little larger than written: corners and coordinates may come from
/// different units, and the rounding of a conversion is forgiven.
struct CornerBox {
  Vec3 low, high;
  bool contains(const Vec3& p) const {
    return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
  }
};

/// From six numbers, two opposite corners; nothing, and a sentence, if there are not six.
std::optional<CornerBox> box_of(const std::vector<Real>& numbers, const TetMesh& mesh,
                                std::string& error);

struct Selection {
  std::vector<Index> nodes;         ///< ascending
  std::vector<Index> tets;          ///< whose middle is in the box
  std::vector<BoundaryFace> faces;  ///< of the boundary, all of whose corners are in the box
};

/// An empty list and an empty name mean everything. Nothing, and a sentence, if there is no such
/// region or the box is not one; an empty selection is left to the caller.
std::optional<Selection> select(const TetMesh& mesh, const std::vector<Real>& box,
                                const std::string& region, std::string& error);

}  // namespace sutura::tissue
