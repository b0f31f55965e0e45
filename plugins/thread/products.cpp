// The tables behind `thread` and `needle` of SutureThread. Where the numbers come from is in
// tests/reference/README.md, section D; a test compares them with d01_threads.csv and
// d02_needles.csv.
#include "products.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <numbers>
#include <sstream>
#include <vector>

#include "sutura/diagnostics.h"
#include "sutura/text.h"
#include "sutura/units.h"

namespace sutura::thread {
namespace {

struct Size {
  const char* name;
  Real diameter;  // m
};
// The middle of the range of the US Pharmacopeia for synthetic sutures; 2-0 near its lower end, as
// in d01.
constexpr std::array sizes{Size{"6-0", 0.085e-3}, Size{"5-0", 0.125e-3}, Size{"4-0", 0.175e-3},
                           Size{"3-0", 0.225e-3}, Size{"2-0", 0.32e-3},  Size{"0", 0.375e-3}};

struct Material {
  const char* name;
  Real young;           // Pa
  Real density;         // kg/m^3
  Real bending_factor;  // braids bend far softer than a solid of their modulus
};
// Silk and polyglactin: initial moduli of Naleway et al. 2015. The others are working values.
constexpr std::array materials{
    Material{"polypropylene", 1.5e9, 910, 1},    Material{"nylon", 2e9, 1140, 1},
    Material{"polydioxanone", 1.2e9, 1300, 1},   Material{"PDS", 1.2e9, 1300, 1},
    Material{"silk", 8.7e9, 1300, 0.05},         Material{"polyglactin", 9e9, 1500, 0.05},
    Material{"polyglactin 910", 9e9, 1500, 0.05}};

struct Wire {
  Real length, diameter;  // m
};
// Typical wire of needles by their length; between two of them it is interpolated.
constexpr std::array wires{Wire{13e-3, 0.4e-3}, Wire{17e-3, 0.5e-3}, Wire{19e-3, 0.55e-3},
                           Wire{26e-3, 0.65e-3}, Wire{36e-3, 0.95e-3}};

struct Share {
  const char* name;
  Real circle;
};
constexpr std::array shares{Share{"1/4", 0.25}, Share{"3/8", 0.375}, Share{"1/2", 0.5},
                            Share{"5/8", 0.625}};

std::vector<std::string> words_of(std::string_view text) {
  std::istringstream in{std::string(text)};
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

template <class Table>
std::vector<std::string> names_of(const Table& table) {
  std::vector<std::string> names;
  for (const auto& entry : table) names.emplace_back(entry.name);
  return names;
}

std::string list_of(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
  return out;
}

template <class Table>
auto find(const Table& table, const std::string& name) {
  return std::find_if(table.begin(), table.end(),
                      [&](const auto& entry) { return lower(entry.name) == lower(name); });
}

/// "; did you mean 'nylon'?", then all there is.
std::string proposals(const std::string& name, const std::vector<std::string>& names) {
  const std::string near = nearest_name(lower(name), names);
  return (near.empty() ? "; " : "; did you mean '" + near + "'? ") + "there is " + list_of(names);
}

Real wire_of(Real length) {
  std::size_t i = 1;
  while (i + 1 < wires.size() && wires[i].length < length) ++i;
  const Wire &a = wires[i - 1], &b = wires[i];
  return a.diameter + (length - a.length) / (b.length - a.length) * (b.diameter - a.diameter);
}

}  // namespace

std::optional<ThreadProduct> find_thread(std::string_view text, std::string& error) {
  const std::vector<std::string> words = words_of(text);
  if (words.size() < 2) {
    error = in_quotes(text) + " is not a size and a material, as in '4-0 polypropylene'; sizes: " +
            list_of(names_of(sizes)) + "; materials: " + list_of(names_of(materials));
    return {};
  }
  const auto size = find(sizes, words[0]);
  if (size == sizes.end()) {
    error = in_quotes(words[0]) + " is not a size of thread" + proposals(words[0], names_of(sizes));
    return {};
  }
  std::string name = words[1];
  for (std::size_t i = 2; i < words.size(); ++i) name += ' ' + words[i];
  const auto material = find(materials, name);
  if (material == materials.end()) {
    error = in_quotes(name) + " is not a material of thread" + proposals(name, names_of(materials));
    return {};
  }
  return ThreadProduct{size->diameter, material->young, material->density,
                       material->bending_factor};
}

std::optional<NeedleProduct> find_needle(std::string_view text, std::string& error) {
  const std::vector<std::string> w = words_of(text);
  std::string length_text, share_name;
  if (w.size() == 4 && w[3] == "circle") {
    length_text = w[0] + ' ' + w[1];
    share_name = w[2];
  } else if (w.size() == 4 && w[1] == "circle") {
    length_text = w[2] + ' ' + w[3];
    share_name = w[0];
  } else if (w.size() == 3 && w[2] == "straight") {
    length_text = w[0] + ' ' + w[1];
  } else {
    error = in_quotes(text) +
            " is not a length and a share of a circle, as in '26 mm 1/2 circle'; shares: " +
            list_of(names_of(shares)) + "; or '26 mm straight'";
    return {};
  }
  const std::optional<Real> length = parse_quantity(length_text, "m", error);
  if (!length) return {};
  // Rounding of the unit aside.
  if (!(*length > wires.front().length - 1e-9 && *length < wires.back().length + 1e-9)) {
    error = "no needle of " + in_quotes(length_text) +
            " is in the table, which goes from 13 mm to " +
            "36 mm; say needle_length, needle_angle and needle_diameter instead";
    return {};
  }
  NeedleProduct needle{*length, 0, wire_of(*length)};
  if (share_name.empty()) return needle;
  const auto share = find(shares, share_name);
  if (share == shares.end()) {
    error = in_quotes(share_name) + " is not a share of a circle that needles have" +
            proposals(share_name, names_of(shares));
    return {};
  }
  needle.angle = 2 * std::numbers::pi * share->circle;
  return needle;
}

}  // namespace sutura::thread
