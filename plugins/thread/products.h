// Needles and threads as one buys them: "4-0 polypropylene", "17 mm 3/8 circle".
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "sutura/types.h"

namespace sutura::thread {

struct ThreadProduct {
  Real diameter = 0;        ///< m
  Real young = 0;           ///< Pa
  Real density = 0;         ///< kg/m^3
  Real bending_factor = 1;  ///< of a braid, below 1
};

struct NeedleProduct {
  Real length = 0;    ///< along the arc, m
  Real angle = 0;     ///< of the arc, rad; 0: straight
  Real diameter = 0;  ///< of the wire, m
};

/// USP size and material. Nothing, and a sentence that says what there is, if the text is neither.
std::optional<ThreadProduct> find_thread(std::string_view text, std::string& error);
/// Length along the arc and share of a circle, in either order, or "26 mm straight".
std::optional<NeedleProduct> find_needle(std::string_view text, std::string& error);

}  // namespace sutura::thread
