// PLY: a header that says what follows, then elements as text or as bytes.
#include "read_triangles.h"
#include "sutura/units.h"

namespace sutura::contact {
namespace {

enum class Form { text, little, big };
enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string name;
  Type type{};
  bool is_list = false;
  Type count_type{};
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

Type type_of(FileCursor& in) {
  static constexpr std::pair<std::string_view, Type> names[] = {
      {"char", Type::int8},      {"int8", Type::int8},       {"uchar", Type::uint8},
      {"uint8", Type::uint8},    {"short", Type::int16},     {"int16", Type::int16},
      {"ushort", Type::uint16},  {"uint16", Type::uint16},   {"int", Type::int32},
      {"int32", Type::int32},    {"uint", Type::uint32},     {"uint32", Type::uint32},
      {"float", Type::float32},  {"float32", Type::float32}, {"double", Type::float64},
      {"float64", Type::float64}};
  const std::string_view word = in.word("a type");
  for (const auto& [name, type] : names)
    if (name == word) return type;
  in.fail("found '" + FileCursor::shortened(word) + "', expected a type like float or uchar");
}

std::vector<Element> read_header(FileCursor& in, Form& form) {
  std::vector<Element> elements;
  in.keyword("ply");
  in.keyword("format");
  const std::string_view word = in.word("a format");
  if (word == "ascii")
    form = Form::text;
  else if (word == "binary_little_endian")
    form = Form::little;
  else if (word == "binary_big_endian")
    form = Form::big;
  else
    in.fail("found '" + FileCursor::shortened(word) +
            "', expected ascii, binary_little_endian or binary_big_endian");
  in.keyword("1.0");
  for (;;) {
    const std::string_view what = in.word("end_header");
    if (what == "comment" || what == "obj_info") {
      in.rest_of_line();
    } else if (what == "element") {
      Element& e = elements.emplace_back();
      e.name = in.word("a name");
      // A value takes a byte at least, or a digit and a blank.
      e.count = in.count("the number of elements", 1);
    } else if (what == "property") {
      if (elements.empty()) in.fail("a property before any element");
      Property& p = elements.back().properties.emplace_back();
      p.is_list = in.peek() == "list";
      if (p.is_list) {
        in.word("list");
        p.count_type = type_of(in);
      }
      p.type = type_of(in);
      p.name = in.word("a name");
    } else if (what == "end_header") {
      in.rest_of_line();
      return elements;
    } else {
      in.fail("found '" + FileCursor::shortened(what) +
              "', expected element, property, comment or end_header");
    }
  }
}

Real value(FileCursor& in, Type type, Form form) {
  if (form == Form::text) return in.real("a number");
  switch (type) {
    case Type::int8:
      return in.binary<std::int8_t>("a number");
    case Type::uint8:
      return in.binary<std::uint8_t>("a number");
    case Type::int16:
      return in.binary<std::int16_t>("a number");
    case Type::uint16:
      return in.binary<std::uint16_t>("a number");
    case Type::int32:
      return in.binary<std::int32_t>("a number");
    case Type::uint32:
      return in.binary<std::uint32_t>("a number");
    case Type::float32:
      return in.binary<float>("a number");
    case Type::float64:
      return in.binary<double>("a number");
  }
  return 0;
}

/// A whole number from 0 to below `limit`.
std::size_t whole(const FileCursor& in, Real x, std::size_t limit, const char* what) {
  if (!(x >= 0 && x < static_cast<Real>(limit)) || x != std::floor(x))
    in.fail(std::string(what) + " is " + plain_number(x) + ", expected a whole number below " +
            std::to_string(limit));
  return static_cast<std::size_t>(x);
}

}  // namespace

TriangleData read_ply(FileCursor& in) {
  Form form = Form::text;
  const std::vector<Element> elements = read_header(in, form);
  constexpr bool is_little = std::endian::native == std::endian::little;
  in.swap_bytes = form == (is_little ? Form::big : Form::little);
  TriangleData out;
  std::vector<Index> polygon;
  for (const Element& e : elements) {
    const bool is_vertex = e.name == "vertex", is_face = e.name == "face";
    if (e.properties.empty() && e.count > 0) in.fail("element " + e.name + " has no properties");
    for (std::size_t i = 0; i < e.count; ++i) {
      Vec3 point = Vec3::Zero();
      polygon.clear();
      for (const Property& p : e.properties) {
        if (!p.is_list) {
          const Real x = value(in, p.type, form);
          for (int k = 0; k < 3; ++k)
            if (p.name == std::string(1, "xyz"[k])) point[k] = x;
          continue;
        }
        const std::size_t n = whole(in, value(in, p.count_type, form), in.left() + 1, "a length");
        const bool is_polygon = p.name == "vertex_indices" || p.name == "vertex_index";
        for (std::size_t k = 0; k < n; ++k) {
          const Real x = value(in, p.type, form);
          if (is_face && is_polygon)
            polygon.push_back(
                static_cast<Index>(whole(in, x, out.points.size(), "the number of a vertex")));
        }
      }
      if (is_vertex) {
        if (!point.allFinite()) in.fail("a coordinate is not a finite number");
        out.points.push_back(point);
      }
      if (is_face && polygon.size() < 3)
        in.fail("a face of " + std::to_string(polygon.size()) + " points, expected three or more");
      for (std::size_t k = 2; k < polygon.size(); ++k)
        out.triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
    }
  }
  return out;
}

}  // namespace sutura::contact
