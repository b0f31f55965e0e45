#include "scene/attributes.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "sutura/text.h"
#include "sutura/units.h"

namespace sutura {

namespace {

std::string with_unit(Real value, const std::string& unit) {
  std::string out = format_real(value);
  if (!unit.empty() && unit != "1") out += ' ' + unit;
  return out;
}

bool in_range(const Range& range, const std::string& unit, Real value, std::string_view text,
              std::string& error) {
  if (range.contains(value)) return true;
  error = in_quotes(text) + " is out of range: it must be " + range_text(range, unit);
  return false;
}

bool read_integer(const AttributeInfo& a, Index& out, std::string_view text, std::string& error) {
  Index value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc{} || end != text.data() + text.size()) {
    error = code == std::errc::result_out_of_range ? in_quotes(text) + " is too large"
                                                   : in_quotes(text) + " is not a whole number";
    return false;
  }
  if (!in_range(a.range, "", static_cast<Real>(value), text, error)) return false;
  out = value;
  return true;
}

bool read_real(const AttributeInfo& a, Real& out, std::string_view text, std::string& error) {
  const std::optional<Real> value = parse_quantity(text, a.unit, error);
  if (!value || !in_range(a.range, a.unit, *value, text, error)) return false;
  out = *value;
  return true;
}

std::optional<std::vector<Real>> read_list(const AttributeInfo& a, std::string_view text,
                                           std::string& error) {
  std::optional<std::vector<Real>> values = parse_quantities(text, a.unit, error);
  if (!values) return std::nullopt;
  for (const Real value : *values)
    if (!in_range(a.range, a.unit, value, text, error)) return std::nullopt;
  return values;
}

bool read_choice(const AttributeInfo& a, Component& owner, std::string_view text,
                 std::string& error) {
  const auto found = std::find(a.choices.begin(), a.choices.end(), text);
  if (found != a.choices.end()) {
    a.set_choice(owner, static_cast<int>(found - a.choices.begin()));
    return true;
  }
  error = in_quotes(text) + " is not one of";
  for (std::size_t i = 0; i < a.choices.size(); ++i) error += (i == 0 ? " " : ", ") + a.choices[i];
  const std::string near = nearest_name(text, a.choices);
  if (!near.empty()) error += "; did you mean '" + near + "'?";
  return false;
}

std::string write_list(const Real* begin, const Real* end, const std::string& unit) {
  std::string out;
  for (const Real* value = begin; value != end; ++value)
    out += (out.empty() ? "" : " ") + format_real(*value);
  if (!out.empty() && unit != "1") out += ' ' + unit;
  return out;
}

}  // namespace

bool read_attribute(const AttributeInfo& a, Component& owner, std::string_view text,
                    std::string& error) {
  switch (a.type) {
    case AttributeType::real:
      return read_real(a, *static_cast<Real*>(a.member(owner)), text, error);
    case AttributeType::integer:
      return read_integer(a, *static_cast<Index*>(a.member(owner)), text, error);
    case AttributeType::flag:
      if (text != "true" && text != "false") {
        error = in_quotes(text) + " is neither 'true' nor 'false'";
        return false;
      }
      *static_cast<bool*>(a.member(owner)) = text == "true";
      return true;
    case AttributeType::text:
      *static_cast<std::string*>(a.member(owner)) = text;
      return true;
    case AttributeType::file:
      if (text.empty()) {
        error = "the name of the file is empty";
        return false;
      }
      static_cast<File*>(a.member(owner))->path = text;
      return true;
    case AttributeType::vec3: {
      const auto values = read_list(a, text, error);
      if (!values) return false;
      if (values->size() != 3) {
        error = in_quotes(text) + " has " + std::to_string(values->size()) +
                (values->size() == 1 ? " number" : " numbers") + "; expected 3";
        return false;
      }
      *static_cast<Vec3*>(a.member(owner)) = Vec3((*values)[0], (*values)[1], (*values)[2]);
      return true;
    }
    case AttributeType::reals: {
      auto values = read_list(a, text, error);
      if (!values) return false;
      *static_cast<std::vector<Real>*>(a.member(owner)) = std::move(*values);
      return true;
    }
    case AttributeType::choice:
      return read_choice(a, owner, text, error);
  }
  return false;
}

std::string write_attribute(const AttributeInfo& a, const Component& component) {
  Component& owner = const_cast<Component&>(component);  // `member` serves reading and writing
  switch (a.type) {
    case AttributeType::real:
      return with_unit(*static_cast<Real*>(a.member(owner)), a.unit);
    case AttributeType::integer:
      return std::to_string(*static_cast<Index*>(a.member(owner)));
    case AttributeType::flag:
      return *static_cast<bool*>(a.member(owner)) ? "true" : "false";
    case AttributeType::text:
      return *static_cast<std::string*>(a.member(owner));
    case AttributeType::file:
      return static_cast<File*>(a.member(owner))->path;
    case AttributeType::vec3: {
      const Vec3& v = *static_cast<Vec3*>(a.member(owner));
      return write_list(v.data(), v.data() + 3, a.unit);
    }
    case AttributeType::reals: {
      const auto& v = *static_cast<std::vector<Real>*>(a.member(owner));
      return write_list(v.data(), v.data() + v.size(), a.unit);
    }
    case AttributeType::choice: {
      const auto i = static_cast<std::size_t>(a.get_choice(owner));
      return i < a.choices.size() ? a.choices[i] : std::string();
    }
  }
  return {};
}

std::string range_text(const Range& r, const std::string& unit) {
  const auto limit = [&](Real value) {
    return plain_number(value) + (unit.empty() || unit == "1" ? "" : ' ' + unit);
  };
  const bool low = std::isfinite(r.low), high = std::isfinite(r.high);
  if (low && high) {
    std::string out = "between " + plain_number(r.low) + " and " + limit(r.high);
    if (r.low_open && r.high_open) return out + ", both excluded";
    if (r.low_open) return out + ", " + plain_number(r.low) + " excluded";
    if (r.high_open) return out + ", " + plain_number(r.high) + " excluded";
    return out;
  }
  if (low) return (r.low_open ? "above " : "at least ") + limit(r.low);
  if (high) return (r.high_open ? "below " : "at most ") + limit(r.high);
  return {};
}

bool is_name(std::string_view text) {
  constexpr std::size_t longest = 100;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  return !text.empty() && text.size() <= longest && is_letter(text.front()) &&
         std::all_of(text.begin(), text.end(),
                     [&](char c) { return is_letter(c) || is_digit(c) || c == '_' || c == '-'; });
}

std::string default_name(std::string_view tag) {
  const auto is_upper = [](char c) { return c >= 'A' && c <= 'Z'; };
  std::string out;
  for (std::size_t i = 0; i < tag.size(); ++i) {
    const bool starts_word =
        i > 0 && is_upper(tag[i]) &&
        (!is_upper(tag[i - 1]) || (i + 1 < tag.size() && !is_upper(tag[i + 1])));
    if (starts_word && out.back() != '_') out += '_';
    out += is_upper(tag[i]) ? static_cast<char>(tag[i] - 'A' + 'a') : tag[i];
  }
  return out;
}

}  // namespace sutura
