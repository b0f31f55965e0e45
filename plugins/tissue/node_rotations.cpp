#include "node_rotations.h"

#include "rotation.h"

namespace sutura::tissue {

void node_rotations(const MeshData& mesh, const VecX& x, std::vector<Mat3>& rotations) {
  rotations.assign(mesh.points.size(), Mat3::Zero());
  for (const Tet& t : mesh.tets) {
    const Mat3 D = tet_edges(t, mesh.points), d = tet_edges(t, x);
    // F times six volumes, without a division: cof D = det D D^-T.
    Mat3 cofactors;
    cofactors << D.col(1).cross(D.col(2)), D.col(2).cross(D.col(0)), D.col(0).cross(D.col(1));
    const Mat3 weighted = d * cofactors.transpose();
    for (const Index i : t) rotations[static_cast<std::size_t>(i)] += weighted;
  }
  for (Mat3& R : rotations) R = nearest_rotation(R / R.norm());
}

}  // namespace sutura::tissue
