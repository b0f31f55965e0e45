// Linear tetrahedra that do not lock: the deformation gradient is averaged before it is strained.
//
// Linear tets have as many volume constraints as elements, five per node: near nu = 0.5 nothing is
// left to bend. Here the deviatoric energy lives on edges (F averaged over the tets around an edge)
// and the volumetric energy on nodes (F averaged over the tets around a node): one volume
// constraint per node, and shear without the stiffness of the single tet. Corotational as the plain
// element: the energy uses the polar rotation of each average. docs/theory/tissue.md has the chart.
// After: Liu and Nguyen-Thoi, smoothed finite elements (edges); Bonet and Burton 1998 (nodal
// volume).
#pragma once

#include <cstdint>
#include <vector>

#include "elastic_model.h"
#include "lanes.h"
#include "mesh_data.h"
#include "rotation.h"

namespace sutura::tissue {

class SmoothedT4 final : public ElasticModel {
 public:
  SmoothedT4(const std::vector<Vec3>& rest, const std::vector<Tet>& tets);

  std::vector<std::array<Index, 2>> pairs() const override;
  void bind(const NodePattern& pattern) override;
  /// Averages are taken within one material: layers do not smear into each other.
  void set_materials(const std::vector<Material>& per_tet) override;
  void linearise(const VecX& x, Real scale, NodeMatrix& A, VecX& force) override;
  void set_viscosity(const VecX& start, Real share) override;
  void add_force(const VecX& x, VecX& force) const override;
  bool averages_volume() const override { return true; }
  Real energy(const VecX& x) const override;

  struct Gradient {
    Lanes at[3];
  };

 private:
  /// Four domains side by side. A domain is what one average is taken over: its nodes (ascending),
  /// and the gradient with which each enters F. Short domains are filled up with gradients of zero.
  struct Pack {
    std::int32_t count;                ///< nodes
    std::size_t gradient, node, slot;  ///< where they start in the arrays below
    Lanes mu, lambda;                  ///< times volume (N m)
    Lanes start[6];                    ///< strain at the start of the step, where it has viscosity
  };
  struct Domains {
    bool shear = false;  ///< false: mu is zero, only the trace of the strain counts
    std::vector<Pack> packs;
    std::vector<Gradient> gradients;  ///< pack.count each
    std::vector<std::int32_t> nodes;  ///< lanes * pack.count each
    std::vector<std::int32_t> slots;  ///< lanes * count (count + 1) / 2 each: blocks a <= b
  };
  struct Share {          ///< of a tet in a domain
    Index first, second;  ///< nodes of the edge; the same one twice for a node
    int material;
    std::size_t tet;
  };

  Domains make_domains(std::vector<Share> shares, const std::vector<Material>& materials,
                       bool shear) const;
  void find_slots(Domains& d) const;
  void deformation_gradient(const Domains& d, const Pack& p, const VecX& x, Small3<Lanes>& F) const;
  /// Work space of one pack: its gradients turned by R.
  using Turned = std::vector<Gradient>;
  struct Stressed {
    Small3<Lanes> R;
    Lanes E[6];
    Turned turned;
  };
  template <bool shear>
  void stress(const Domains& d, const Pack& p, const VecX& x, Stressed& s, VecX& force) const;
  template <bool shear>
  void add(const Domains& d, const VecX& x, Real scale, NodeMatrix& A, VecX& force);

  Index node_count_;
  std::vector<Tet> tets_;
  std::vector<Real> volume_;                         ///< m^3, per tet
  std::vector<Eigen::Matrix<Real, 3, 4>> gradient_;  ///< of the shape functions, per tet (1/m)
  const NodePattern* pattern_ = nullptr;
  Domains edges_, nodes_;
  Real viscous_share_ = 0;
  mutable Stressed work_;
};

}  // namespace sutura::tissue
