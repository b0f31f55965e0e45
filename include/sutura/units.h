// Numbers with units in text: "30 kPa", "1.2e-3", "20 ms". Independent of the process locale.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sutura/types.h"

namespace sutura {

/// A finite number and nothing else (no unit, no trailing characters); std::from_chars underneath.
std::optional<Real> parse_real(std::string_view text);

/// A number with an optional unit that must have the dimension of `si_unit` ("Pa", "N/m", "kg/m^3",
/// "1" for a pure number); returns SI, or nothing and a sentence in `error`.
std::optional<Real> parse_quantity(std::string_view text, std::string_view si_unit,
                                   std::string& error);

/// A blank- or comma-separated list with one optional unit at its end that holds for all of it:
/// "0 0 5 mm".
std::optional<std::vector<Real>> parse_quantities(std::string_view text, std::string_view si_unit,
                                                  std::string& error);

/// The shortest text that reads back as the same number.
std::string format_real(Real value);

/// As people write limits and numbers of things: 100000, not 1e+05.
std::string plain_number(Real value);

}  // namespace sutura
