#include "base/unit_expression.h"

#include <array>
#include <charconv>
#include <numbers>
#include <vector>

#include "sutura/diagnostics.h"

namespace sutura {

namespace {

struct Symbol {
  std::string_view name;
  Unit unit;
  bool takes_prefix;
};

constexpr std::array symbols{
    Symbol{"1", {}, false},
    Symbol{"%", {{}, -2, 1}, false},
    Symbol{"m", {{1, 0, 0}, 0, 1}, true},
    Symbol{"g", {{0, 1, 0}, -3, 1}, true},
    Symbol{"s", {{0, 0, 1}, 0, 1}, true},
    Symbol{"min", {{0, 0, 1}, 0, 60}, false},
    Symbol{"N", {{1, 1, -2}, 0, 1}, true},
    Symbol{"Pa", {{-1, 1, -2}, 0, 1}, true},
    Symbol{"J", {{2, 1, -2}, 0, 1}, true},
    Symbol{"W", {{2, 1, -3}, 0, 1}, true},
    Symbol{"Hz", {{0, 0, -1}, 0, 1}, true},
    Symbol{"rad", {{}, 0, 1}, true},
    Symbol{"deg", {{}, 0, std::numbers::pi / 180}, false},
};

struct Prefix {
  std::string_view name;
  int power;
};
constexpr std::array prefixes{Prefix{"n", -9}, Prefix{"u", -6}, Prefix{"\u00b5", -6},
                              Prefix{"m", -3}, Prefix{"c", -2}, Prefix{"k", 3},
                              Prefix{"M", 6},  Prefix{"G", 9}};

std::optional<Unit> find_symbol(std::string_view name) {
  for (const Symbol& s : symbols)
    if (s.name == name) return s.unit;
  for (const Prefix& p : prefixes) {
    if (!name.starts_with(p.name)) continue;
    for (const Symbol& s : symbols) {
      if (!s.takes_prefix || s.name != name.substr(p.name.size())) continue;
      Unit unit = s.unit;
      unit.power += p.power;
      return unit;
    }
  }
  return std::nullopt;
}

/// The spellings worth proposing for a misspelt one.
const std::vector<std::string>& common_symbols() {
  static const std::vector<std::string> names{
      "m",  "mm", "cm",  "um",  "km",  "kg", "g",  "mg", "s",  "ms",  "us",  "min",  "N",  "mN",
      "kN", "Pa", "kPa", "MPa", "GPa", "J",  "mJ", "W",  "Hz", "kHz", "rad", "mrad", "deg"};
  return names;
}

std::string unknown_symbol(std::string_view name) {
  std::string out = "'" + std::string(name) + "' is not a unit";
  const std::string near = nearest_name(name, common_symbols());
  if (!near.empty()) out += "; did you mean '" + near + "'?";
  return out;
}

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

void multiply(Unit& unit, const Unit& by, int exponent) {
  unit.dimension.metre += exponent * by.dimension.metre;
  unit.dimension.kilogram += exponent * by.dimension.kilogram;
  unit.dimension.second += exponent * by.dimension.second;
  unit.power += exponent * by.power;
  for (int i = 0; i < exponent; ++i) unit.factor *= by.factor;
  for (int i = 0; i > exponent; --i) unit.factor /= by.factor;
}

}  // namespace

std::optional<Unit> parse_unit(std::string_view text, std::string& error) {
  constexpr int largest_exponent = 9;
  Unit unit;
  bool any = false;
  bool divided = false;
  std::size_t i = 0;
  const auto skip_blanks = [&] {
    while (i < text.size() && is_blank(text[i])) ++i;
  };
  for (skip_blanks(); i < text.size(); skip_blanks()) {
    bool divide = false;
    if (any && (text[i] == '/' || text[i] == '*')) {
      divide = text[i] == '/';
      ++i;
      skip_blanks();
    }
    if (divided && !divide) {
      error = "'" + std::string(text) + "' is ambiguous as a unit: after a '/' only '/' may follow";
      return std::nullopt;
    }
    const std::size_t begin = i;
    while (i < text.size() && !is_blank(text[i]) && text[i] != '/' && text[i] != '*' &&
           text[i] != '^')
      ++i;
    const std::string_view name = text.substr(begin, i - begin);
    if (name.empty()) {
      error = "'" + std::string(text) + "' is not a unit: a factor is missing";
      return std::nullopt;
    }
    if (any && name == "1") {
      error = "'" + std::string(text) + "' is not a unit: 1 stands at its beginning only";
      return std::nullopt;
    }
    const std::optional<Unit> symbol = find_symbol(name);
    if (!symbol) {
      error = unknown_symbol(name);
      return std::nullopt;
    }
    int exponent = 1;
    if (i < text.size() && text[i] == '^') {
      ++i;
      const auto [end, code] =
          std::from_chars(text.data() + i, text.data() + text.size(), exponent);
      if (code != std::errc{} || exponent > largest_exponent || exponent < -largest_exponent) {
        error = "'" + std::string(text) + "' is not a unit: a small whole number must follow '^'";
        return std::nullopt;
      }
      i = static_cast<std::size_t>(end - text.data());
    }
    multiply(unit, *symbol, divide ? -exponent : exponent);
    divided = divided || divide;
    any = true;
    const bool at_boundary =
        i >= text.size() || is_blank(text[i]) || text[i] == '/' || text[i] == '*';
    if (!at_boundary) {
      error = "'" + std::string(text) + "' is not a unit: it goes on after an exponent";
      return std::nullopt;
    }
  }
  if (!any) {
    error = "the unit is empty";
    return std::nullopt;
  }
  return unit;
}

}  // namespace sutura
