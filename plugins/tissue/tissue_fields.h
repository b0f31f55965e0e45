// What a tissue shows: sums over its state, and fields for recorders. Positions and velocities are
// three numbers per node.
#pragma once

#include <span>

#include "sutura/body.h"
#include "tissue_model.h"

namespace sutura::tissue {

Real sum(std::span<const Real> values);
Vec3 momentum(const TissueModel& model, const VecX& v);        ///< kg m/s
Vec3 centre_of_mass(const TissueModel& model, const VecX& x);  ///< m
Real kinetic_energy(const TissueModel& model, const VecX& v);  ///< J
Index inverted_tets(const TissueModel& model, const VecX& x);  ///< of negative or zero volume
/// Share of the volume (at rest) in which the law of the material has no shear stiffness left: the
/// compression of the volume is beyond (1 - 2 nu) / nu.
Real collapsed_share(const TissueModel& model, const VecX& x);
Real max_displacement(const TissueModel& model, const VecX& x);  ///< m
Vec3 lowest_node(const VecX& x);  ///< position of the one with the smallest z (m)
BodyGeometry geometry(const TissueModel& model, const VecX& x, const VecX& v);

}  // namespace sutura::tissue
