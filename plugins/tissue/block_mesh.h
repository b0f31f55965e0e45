// <BlockMesh box="0 0 0  100 20 20 mm" cells="20 4 4"/>: a block of tetrahedra, without a file.
#pragma once

#include "tet_mesh.h"

namespace sutura::tissue {

class BlockMesh : public TetMesh {
 public:
  std::vector<Real> box;      ///< m: two opposite corners
  std::vector<Real> corners;  ///< m: eight corners, instead
  std::vector<Real> cells;
  std::vector<Real> holes;  ///< m: boxes, two corners each
  std::vector<Real> cuts;   ///< m: flat boxes, two corners each

  static void describe(Describe<BlockMesh>& d);
  void initialise(Setup& setup) override;

 private:
  MeshData build(const std::array<Vec3, 8>& corner, const std::array<Index, 3>& n) const;
  /// What is wrong with a cut: a sentence, or empty.
  std::string open_cuts(MeshData& mesh) const;
  Vec3 corner_of_cut(std::size_t cut, std::size_t corner) const;
};

}  // namespace sutura::tissue
