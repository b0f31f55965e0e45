// Linear tetrahedra with a rotation of their own: W = V (mu |S - I|^2 + lambda/2 tr(S - I)^2),
// F = R S, R the polar rotation (docs/theory/tissue.md).
#pragma once

#include <cstdint>

#include "elastic_model.h"
#include "lanes.h"
#include "mesh_data.h"
#include "rotation.h"

namespace sutura::tissue {

class CorotationalT4 final : public ElasticModel {
 public:
  CorotationalT4(const std::vector<Vec3>& rest, const std::vector<Tet>& tets);

  std::vector<std::array<Index, 2>> pairs() const override;
  void bind(const NodePattern& pattern) override;
  void set_materials(const std::vector<Material>& per_tet) override;
  /// K is the exact derivative where nothing is compressed, and positive semidefinite everywhere
  /// (twist_stiffness.h).
  void linearise(const VecX& x, Real scale, NodeMatrix& A, VecX& force) override;
  void set_viscosity(const VecX& start, Real share) override;
  void add_force(const VecX& x, VecX& force) const override;
  Real energy(const VecX& x) const override;
  bool tets(TetElementsView& view, Index& revision) override;

 private:
  /// Four tets side by side, their nodes sorted so that every block (a, b), a < b, is an upper one.
  /// The last pack is filled up with repetitions of no stiffness.
  struct Pack {
    Lanes gradient[3][3];  ///< [node 1..3][axis] (1/m); node 0 has minus their sum
    Lanes volume;          ///< m^3
    Lanes mu, lambda;      ///< times volume (N m)
    Lanes start[6];        ///< strain at the start of the step, where it has viscosity
    std::int32_t node[4][lanes];
    std::int32_t slot[10][lanes];  ///< blocks 00 01 02 03 11 12 13 22 23 33
  };
  /// What forces and tangent of four tets are made of.
  struct Stressed {
    Small3<Lanes> R;
    Lanes E[6];
    Lanes g[4][3];  ///< gradients of the nodes, turned by R (1/m)
  };
  void deformation_gradient(const Pack& p, const VecX& x, Small3<Lanes>& F) const;
  void stress(const Pack& p, const VecX& x, Stressed& s, VecX& force) const;

  std::vector<Pack> packs_;
  Real viscous_share_ = 0;
  std::vector<std::array<Index, 4>> sorted_;  ///< nodes of each tet, ascending

  /// The same tets one after the other, for a device; empty until it asks.
  struct Listed {
    std::vector<std::int32_t> node, slot;
    std::vector<Real> gradient, volume, moduli;
  };
  Listed listed_;
  Index revision_ = 0, listed_revision_ = -1;
};

}  // namespace sutura::tissue
