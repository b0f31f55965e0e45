// What an element family offers to the tissue: forces and tangent blocks at given positions.
#pragma once

#include <array>
#include <vector>

#include "block_matrix.h"
#include "sutura/device.h"
#include "sutura/types.h"

namespace sutura::tissue {

/// Isotropic material of one region.
struct Material {
  Real young = 3e3;                                             ///< Pa
  Real poisson = 0.45;                                          ///< below 0.5
  Real density = 1000;                                          ///< kg/m^3
  Real lame_mu() const { return young / (2 * (1 + poisson)); }  // Pa
  Real lame_lambda() const { return young * poisson / ((1 + poisson) * (1 - 2 * poisson)); }  // Pa
};

/// One per tissue, made from its rest positions and tets. Positions and forces are 3 n numbers in
/// the order of the nodes.
class ElasticModel {
 public:
  virtual ~ElasticModel() = default;

  /// Pairs i < j of nodes whose block of K can be nonzero, sorted, each once.
  virtual std::vector<std::array<Index, 2>> pairs() const = 0;
  /// Looks up once where its blocks go; `pattern` contains at least `pairs`.
  virtual void bind(const NodePattern& pattern) = 0;
  /// Materials per tet. Called before the first `linearise`, and again if they change.
  virtual void set_materials(const std::vector<Material>& per_tet) = 0;

  /// Gives the material viscosity (Kelvin-Voigt) for a step of length h from the positions `start`:
  /// until the next call, forces are those of the strain E + beta/h (E - E at the start). `share`
  /// is beta/(h + beta); 0: elastic. A body that moves rigidly has no viscous force, however far it
  /// turns in the step.
  virtual void set_viscosity(const VecX& start, Real share) = 0;
  /// force += -dE/dx (N); A += scale * K for every block, fixed nodes included (the solver masks
  /// them: reactions need their rows). With viscosity, K is (1 - share) of the tangent.
  virtual void linearise(const VecX& x, Real scale, NodeMatrix& A, VecX& force) = 0;
  /// force += -dE/dx (N), alone.
  virtual void add_force(const VecX& x, VecX& force) const = 0;
  /// For a device, after `bind` and `set_materials`; false if it is another element. `revision`
  /// changes when the numbers do.
  virtual bool tets(TetElementsView&, Index& /*revision*/) { return false; }
  /// Is the strain of volume averaged over the tets around each node that are of one material?
  virtual bool averages_volume() const { return false; }
  /// Elastic energy (J).
  virtual Real energy(const VecX& x) const = 0;
};

}  // namespace sutura::tissue
