// What a tissue is made of: rest shape, masses, elements, material, and what holds it. Written
// while the scene is set up, then the same for the whole run, but for where carried nodes are to
// go.
#pragma once

#include <memory>
#include <vector>

#include "block_matrix.h"
#include "elastic_model.h"
#include "held_nodes.h"
#include "mesh_data.h"

namespace sutura::tissue {

/// A load that depends on where the surface is.
class FollowerLoad {
 public:
  virtual ~FollowerLoad() = default;
  /// Puts its force at positions x into `load`, in place of what it put there last (N).
  virtual void follow(const VecX& x, VecX& load) = 0;
  /// A += scale times the symmetric part of its stiffness there (N/m).
  virtual void add_stiffness(const VecX& x, Real scale, NodeMatrix& A) const = 0;
};

struct TissueModel {
  const MeshData* mesh = nullptr;
  VecX rest;                        ///< positions (m), three numbers per node
  std::vector<Real> mass;           ///< lumped, per node (kg)
  std::vector<Material> materials;  ///< per tet
  std::unique_ptr<ElasticModel> elastic;
  HeldNodes held;
  std::vector<FollowerLoad*> followers;
  Real edge_length = 0;                          ///< mean, at rest (m)
  Real young = 0;                                ///< of the stiffest tet (Pa)
  Real damping_mass = 0, damping_stiffness = 0;  ///< 1/s, s

  Index dofs() const { return rest.size(); }
};

}  // namespace sutura::tissue
