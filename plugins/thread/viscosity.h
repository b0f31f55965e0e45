// What a beam dissipates in a step (Kelvin-Voigt): beta/h times the elastic energy of the change
// that its strain, bend and twist had since the start of the step,
//
//   D = beta/h [ L/2 EA de^2 + EI/2L (k1 (|da|^2 + |db|^2) + 2 k2 da.db) + GJ/2L dphi^2 ],
//
// with da, db the changes of theta_a, theta_b (element.h) as each section sees them. A beam that
// moves as a rigid body dissipates nothing, however far it turns in the step. K v would not do: the
// displacement of a turn by angle t has a stretch of t^2/2 in it.
#pragma once

#include "element.h"

namespace sutura::thread {

/// How a beam is deformed, in measures that a rigid motion leaves as they are.
struct Deformation {
  Real strain = 0, twist = 0;  ///< -, rad
  Vec3 bend_a, bend_b;         ///< theta_a, theta_b in the axes of their sections, rad
  Deformation() : bend_a(Vec3::Zero()), bend_b(Vec3::Zero()) {}
  Deformation(const ElementState& state, const Pose& a, const Pose& b);
};

/// The change of a beam's deformation since the start of the step, bends in world axes.
struct DeformationChange {
  Real strain, twist;
  Vec3 bend_a, bend_b;
  DeformationChange(const ElementState& state, const Pose& a, const Pose& b,
                    const Deformation& start);
};

/// D h / beta (J).
Real viscous_energy(const ElementRest& rest, const DeformationChange& change);

/// Its exact gradient, like that of the elastic energy (element.h).
ElementGradient viscous_gradient(const ElementRest& rest, const ElementState& state,
                                 const DeformationChange& change);

}  // namespace sutura::thread
