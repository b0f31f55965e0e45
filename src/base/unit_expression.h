// Units in text: "kPa", "N/m", "g/cm^3", "N s/m^2".
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace sutura {

/// Exponents of the base units; an angle has no dimension.
struct Dimension {
  int metre = 0;
  int kilogram = 0;
  int second = 0;
  bool operator==(const Dimension&) const = default;
};

/// One of the unit is factor * 10^power of SI. The power of ten is kept apart so that "0.3 mm"
/// reads as exactly the number that "0.3e-3" reads as.
struct Unit {
  Dimension dimension;
  int power = 0;
  double factor = 1;
};

/// Factors apart by blanks or '*', each with an optional whole exponent ("m^2", "s^-1"); '/'
/// divides by the one factor after it, and only '/' may follow ("N/m s" is ambiguous and refused).
/// Nothing, and a sentence in `error`, if the text is no unit.
std::optional<Unit> parse_unit(std::string_view text, std::string& error);

}  // namespace sutura
