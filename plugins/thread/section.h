// Cross-section of needle and thread: a solid circle, whose bending and torsion may be softened for
// braids.
#pragma once

#include <numbers>

#include "sutura/types.h"

namespace sutura::thread {

struct Section {
  Real radius = 0.15e-3;    ///< m
  Real young = 2e9;         ///< Pa
  Real poisson = 0.4;       ///< 1
  Real density = 1140;      ///< kg/m^3
  Real bending_factor = 1;  ///< braids bend and twist softer than a solid of their modulus

  Real area() const { return std::numbers::pi * radius * radius; }
  Real second_moment() const { return area() * radius * radius / 4; }
  Real axial_stiffness() const { return young * area(); }  ///< EA, N
  Real bending_stiffness() const {
    return young * second_moment() * bending_factor;
  }  ///< EI, N m^2
  /// GJ, N m^2; the polar moment of a circle is twice the second moment.
  Real torsion_stiffness() const { return bending_stiffness() / (1 + poisson); }
  /// kappa G A, N, with the coefficient of Cowper (1966) for the circle.
  Real shear_stiffness() const {
    const Real kappa = 6 * (1 + poisson) / (7 + 6 * poisson);
    return kappa * young / (2 * (1 + poisson)) * area();
  }
  bool operator==(const Section&) const = default;
};

}  // namespace sutura::thread
