// What a material may be, and what it hardly is: the ranges of Tissue and Layer, and their doubts.
#pragma once

#include <string>

#include "elastic_model.h"
#include "sutura/component.h"
#include "sutura/describe.h"
#include "sutura/units.h"

namespace sutura::tissue {

inline constexpr Range young_range{.low = 1e-3, .high = 1e15};    // Pa
inline constexpr Range density_range{.low = 1e-12, .high = 1e9};  // kg/m^3
/// Above it plain linear tets are too stiff: 10 to 35 % in bending on ordinary meshes at 0.45
/// (docs/theory/tissue.md).
inline constexpr Real locking_poisson = 0.4;
inline constexpr const char* too_stiff =
    "plain tetrahedra bend 10 to 35 % too stiffly on ordinary meshes; element=\"smoothed\" is "
    "accurate at three to four times the cost, element=\"t4\" accepts it";

/// Warns of numbers that are allowed, but more likely a slip of the unit.
inline void doubt_material(const Component& who, Setup& setup, const Material& m) {
  if (m.young < 100)
    setup.warning(who, "young is " + format_real(m.young) +
                           " Pa, softer than any tissue (brain has about 1 kPa); were kPa meant?");
  if (m.young > 1e9)
    setup.warning(who, "young is " + format_real(m.young) +
                           " Pa, stiffer than any soft tissue (tendon has about 1 GPa); is the "
                           "unit right?");
  if (m.density < 100 || m.density > 5000)
    setup.warning(who, "density is " + format_real(m.density) +
                           " kg/m^3, and soft tissue has about 1000; is the unit right?");
}

}  // namespace sutura::tissue
