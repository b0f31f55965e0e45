#include "sutura/units.h"

#include <array>
#include <charconv>
#include <cmath>

#include "base/unit_expression.h"
#include "sutura/text.h"

namespace sutura {

namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Characters at the start of `text` that spell a decimal number; 0 if there is none. Infinities
/// and NaN are not numbers here.
std::size_t number_length(std::string_view text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0;
  const auto skip_digits = [&] {
    const std::size_t begin = i;
    while (i < text.size() && is_digit(text[i])) ++i;
    return i - begin;
  };
  if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
  std::size_t digits = skip_digits();
  if (i < text.size() && text[i] == '.') {
    ++i;
    digits += skip_digits();
  }
  if (digits == 0) return 0;
  const std::size_t mantissa = i;
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    ++i;
    if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
    if (skip_digits() == 0) return mantissa;
  }
  return i;
}

/// The value of `number` (as measured by number_length) times 10^power, rounded once.
std::optional<Real> decimal(std::string_view number, int power) {
  if (number.starts_with('+')) number.remove_prefix(1);
  std::string shifted;
  if (power != 0) {
    const std::size_t e = number.find_first_of("eE");
    int exponent = 0;
    if (e != std::string_view::npos) {
      std::string_view digits = number.substr(e + 1);
      if (digits.starts_with('+')) digits.remove_prefix(1);
      const auto [end, code] =
          std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
      if (code != std::errc{} || exponent > 100000 || exponent < -100000) return std::nullopt;
    }
    shifted = std::string(number.substr(0, e)) + 'e' + std::to_string(exponent + power);
    number = shifted;
  }
  Real value = 0;
  const auto [end, code] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (code != std::errc{} || end != number.data() + number.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

/// "mm 2 mm": somebody gave every number a unit of its own. The factor 1 of "1/s" is no number.
bool has_number_after_blank(std::string_view text) {
  for (std::size_t i = 1; i < text.size(); ++i)
    if (is_blank(text[i - 1]) && number_length(text.substr(i)) > 0) return true;
  return false;
}

/// What to say when the text should start with a number and does not.
std::string not_a_number(std::string_view text) {
  if (text.empty()) return "the value is empty; a number was expected";
  return in_quotes(text) + " is not a number";
}

/// The unit behind the number(s), checked against the expected one.
std::optional<Unit> expected_unit(std::string_view text, std::string_view si_unit,
                                  std::string_view whole, std::string& error) {
  std::string why;
  const std::optional<Unit> expected = parse_unit(si_unit, why);
  if (!expected) {
    error = "the attribute itself has a faulty unit: " + why;
    return std::nullopt;
  }
  if (text.empty()) return Unit{expected->dimension, 0, 1};
  if (text.front() == ',') {
    error = in_quotes(whole) + " is not a number; the decimal sign is a point";
    return std::nullopt;
  }
  const bool is_reciprocal = text.front() == '1' && trim(text.substr(1)).starts_with('/');
  if (number_length(text) > 0 && !is_reciprocal) {
    error = in_quotes(whole) + " has more than one number";
    return std::nullopt;
  }
  const std::optional<Unit> unit = parse_unit(text, why);
  if (!unit) {
    error = in_quotes(whole) + ": " + why;
    return std::nullopt;
  }
  if (unit->dimension != expected->dimension) {
    error = in_quotes(whole) + " has the wrong unit: expected ";
    error += si_unit == "1" ? "a pure number" : "a unit like " + std::string(si_unit);
    return std::nullopt;
  }
  return unit;
}

std::optional<Real> scaled(std::string_view number, const Unit& unit, std::string& error) {
  std::optional<Real> value = decimal(number, unit.power);
  if (value) *value *= unit.factor;
  if (value && std::isfinite(*value)) return value;
  error = in_quotes(number) + " is too large or too small for a number";
  return std::nullopt;
}

}  // namespace

std::optional<Real> parse_real(std::string_view text) {
  text = trim(text);
  if (text.empty() || number_length(text) != text.size()) return std::nullopt;
  return decimal(text, 0);
}

std::optional<Real> parse_quantity(std::string_view text, std::string_view si_unit,
                                   std::string& error) {
  text = trim(text);
  const std::size_t length = number_length(text);
  if (length == 0) {
    error = not_a_number(text);
    return std::nullopt;
  }
  const std::optional<Unit> unit = expected_unit(trim(text.substr(length)), si_unit, text, error);
  if (!unit) return std::nullopt;
  return scaled(text.substr(0, length), *unit, error);
}

std::optional<std::vector<Real>> parse_quantities(std::string_view text, std::string_view si_unit,
                                                  std::string& error) {
  text = trim(text);
  std::vector<std::string_view> numbers;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t length = number_length(rest);
    const bool is_unit = length == 0 || (length < rest.size() && rest[length] == '/');  // "1/s"
    if (is_unit) break;
    numbers.push_back(rest.substr(0, length));
    rest.remove_prefix(length);
    if (!rest.empty() && (number_length(rest) > 0 || rest.front() == '.')) {  // "12-3", "1.2.3"
      error = in_quotes(text) + ": " + in_quotes(numbers.back()) + " is followed by " +
              in_quotes(rest) + " without a blank";
      return std::nullopt;
    }
    rest = trim(rest);
    if (!rest.starts_with(',')) continue;
    rest = trim(rest.substr(1));
    if (number_length(rest) == 0) {
      error = in_quotes(text) + ": a number is missing after a comma";
      return std::nullopt;
    }
  }
  if (numbers.empty()) {
    error = text.empty() ? "the value is empty; numbers were expected" : not_a_number(text);
    return std::nullopt;
  }
  if (rest.find_first_of(".,;") != std::string_view::npos || has_number_after_blank(rest)) {
    error = in_quotes(text) + ": one unit, at the end, holds for the whole list";
    return std::nullopt;
  }
  const std::optional<Unit> unit = expected_unit(rest, si_unit, text, error);
  if (!unit) return std::nullopt;
  std::vector<Real> values;
  values.reserve(numbers.size());
  for (const std::string_view number : numbers) {
    const std::optional<Real> value = scaled(number, *unit, error);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

std::string format_real(Real value) {
  std::array<char, 32> buffer;
  const auto [end, code] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return std::string(buffer.data(), end);
}

std::string plain_number(Real value) {
  constexpr Real plain_below = 1e7;
  if (value == std::floor(value) && std::abs(value) < plain_below)
    return std::to_string(static_cast<long>(value));
  return format_real(value);
}

}  // namespace sutura
