// One beam of the thread: a corotational element of 12 dofs (position and spin of two sections,
// world axes) that derives from an energy.
//
// The beam sees its chord (length l, direction e) and two directors c_a, c_b: the rest direction of
// the chord, carried along by each end section. With theta = angle vector from e to c (so zero at
// rest),
//
//   U = L/2 EA eps^2 + EI/2L [k1 (|theta_a|^2 + |theta_b|^2) + 2 k2 theta_a.theta_b] + GJ/2L phi^2
//   eps = (l - l0)/L + [2|tau_a|^2 - tau_a.tau_b + 2|tau_b|^2]/30 - rest value      (bowing, Oran
//   1973) k1 = (4 + Phi)/(1 + Phi), k2 = (2 - Phi)/(1 + Phi), Phi = 12 EI/(kappa G A L^2)
//   (Timoshenko)
//
// tau = theta + rest angle of the section; phi is the angle left between the two directors' frames
// after parallel transport from c_a to c_b, counted without wrapping. Bowing makes the strain that
// of the arc and not of the chord, which is what lifts the element from second to fourth order.
//
// Because the section is round, U depends on scalars alone: l, mu_a = e.c_a, mu_b = e.c_b, m =
// c_a.c_b, phi (and nu = e.(c x z) for beams curved at rest); force and Hessian follow by the chain
// rule, with no element frame to differentiate. docs/theory/thread.md has the derivation.
#pragma once

#include "section.h"

namespace sutura::thread {

using Mat9 = Eigen::Matrix<Real, 9, 9>;
using Mat12 = Eigen::Matrix<Real, 12, 12>;
using Vec9 = Eigen::Matrix<Real, 9, 1>;

/// Constants of a beam, from its rest shape and section.
struct ElementRest {
  Quat frame_a, frame_b;  ///< from the section to the frame whose x axis is the rest chord
  Vec3 bow_a, bow_b;      ///< z of the bow's linear term, in section axes; zero if straight at rest
  bool curved = false;
  Real length = 0;   ///< arc length L, m
  Real chord = 0;    ///< l0, m
  Real axial = 0;    ///< EA, N
  Real bend_1 = 0;   ///< EI k1/L, N m
  Real bend_2 = 0;   ///< EI k2/L, N m
  Real torsion = 0;  ///< GJ/L, N m
  Real mass = 0;     ///< kg
  Real rotary = 0;   ///< density times second moment, kg m

  /// Rest poses of the two sections (x axis = tangent) and the arc length between them.
  ElementRest(const Pose& a, const Pose& b, Real arc_length, const Section& section);
};

/// What the element looks like now: the scalars of the energy and the vectors of their gradients.
struct ElementState {
  Vec3 e, ca, cb, ta, tb;  ///< chord direction; directors; section tangents (unit)
  Vec3 na, nb;             ///< c x z, only when curved
  Vec3 theta_a, theta_b;   ///< rad
  Vec3 twist_axis;         ///< d phi = twist_axis . (spin_b - spin_a)
  Real l = 0, xa = 0, xb = 0, m = 0, product = 0;  ///< x = 1 - mu; product = (e x ca).(e x cb)
  Real ga = 0, gb = 0, dga = 0, dgb = 0;           ///< g = angle/sin and dg/dx
  Real strain = 0, tension = 0, twist = 0;         ///< eps, EA eps (N), phi (rad)
};

/// `twist_reference`: any value within half a turn of phi; chooses the branch.
void evaluate(const ElementRest& rest, const Pose& a, const Pose& b, Real twist_reference,
              ElementState& state);

Real elastic_energy(const ElementRest& rest, const ElementState& state);

/// dU for a change (v, spin_a, spin_b) with v = velocity of b minus velocity of a. The force on the
/// ends is minus this, with +v part on a and -v part on b.
struct ElementGradient {
  Vec3 v, a, b;
};
ElementGradient gradient(const ElementRest& rest, const ElementState& state);

/// d eps / d (v, spin_a, spin_b).
Vec9 strain_gradient(const ElementRest& rest, const ElementState& state);

/// Symmetric 9 x 9 in blocks over (v, spin_a, spin_b).
struct ElementMatrix {
  Mat3 vv, va, vb, aa, ab, bb;
};
/// m + c I
inline Mat3 plus_diagonal(Mat3 m, Real c) {
  m.diagonal().array() += c;
  return m;
}
/// Stiffness for the time step: the material part, and the geometric part of `tension` (N); that of
/// the moments is left out. Positive semidefinite unless `tension` is negative.
/// `chord_roll`: how much the chord rolls of what its ends do. Two motions of a bent beam cost
/// nothing, and no semidefinite form is zero for both: with 1 it is that all of the beam rolls
/// about its chord, as where a loop swings; with 0 that it rolls about its own axis, as in a knot.
void step_stiffness(const ElementRest& rest, const ElementState& state, Real tension,
                    Real chord_roll, ElementMatrix& k);

/// The Hessian of U with respect to (v, spin_a, spin_b), rotations varied by the exponential map.
void hessian(const ElementRest& rest, const ElementState& state, Mat9& k);
void hessian(const ElementRest& rest, const ElementState& state, ElementMatrix& k);

/// Consistent mass: the kinetic energy of the Hermite cubic through the nodes with the section
/// tangents t_a, t_b (so that momentum and centre of mass are those of the curve that is drawn),
/// plus rotary inertia of linearly interpolated spins. With [t] the matrix of v -> t x v, the
/// blocks of M over (x_a, spin_a, x_b, spin_b) are
///   x_a x_a: same I            x_a x_b: other I
///   x_a spin_a: -couple_same [t_a]         x_a spin_b: -couple_other [t_b]
///   x_b spin_b: +couple_same [t_b]         x_b spin_a: +couple_other [t_a]
///   spin_a spin_a: spin_same (I - t_a t_a^T) + roll_same (I + e e^T)
///   spin_a spin_b: spin_other (t_a.t_b I - t_b t_a^T) + roll_other (I + e e^T)
struct ElementMass {
  Real same, other;                ///< kg
  Real couple_same, couple_other;  ///< kg m
  Real spin_same, spin_other;      ///< kg m^2
  Real roll_same, roll_other;      ///< kg m^2
  explicit ElementMass(const ElementRest& rest);
};

/// The 12 x 12 matrices, for tests and small uses.
Mat12 expand(const ElementMatrix& k);
Mat12 expand(const Mat9& k);
Mat12 mass_matrix(const ElementMass& m, const Vec3& e, const Vec3& ta, const Vec3& tb);

}  // namespace sutura::thread
