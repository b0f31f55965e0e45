#include "read_triangles.h"

namespace sutura::contact {
namespace {

bool is_binary_stl(std::string_view bytes) {
  constexpr std::size_t head = 84, each = 50;
  if (bytes.size() < head) return false;
  FileCursor in(bytes.substr(80));
  in.swap_bytes = std::endian::native != std::endian::little;
  return (bytes.size() - head) / each == in.binary<std::uint32_t>("the number of triangles") &&
         (bytes.size() - head) % each == 0;
}

TriangleData read_any(std::string_view bytes) {
  if (is_binary_stl(bytes)) return read_stl_binary(bytes);
  FileCursor in(bytes);
  const std::string first(in.peek());
  if (first.empty()) throw FileProblem{0, "the file is empty"};
  if (first == "ply") return read_ply(in);
  if (first == "solid") return read_stl(in);
  for (const unsigned char c : bytes.substr(0, 256))
    if (c == 0) throw FileProblem{0, "neither OBJ, STL nor PLY: a binary file of another kind"};
  return read_obj(in);
}

Vec3 read_point(FileCursor& in) {
  Vec3 p;
  for (Real& x : p) x = in.real("a coordinate");
  return p;
}

void add_triangle(TriangleData& out, const Vec3 (&corners)[3]) {
  const auto n = static_cast<Index>(out.points.size());
  for (const Vec3& p : corners) out.points.push_back(p);
  out.triangles.push_back({n, n + 1, n + 2});
}

}  // namespace

TriangleReading read_triangle_text(std::string_view bytes) {
  try {
    TriangleReading reading{read_any(bytes), {}};
    if (reading.data.triangles.empty()) throw FileProblem{0, "there are no triangles in it"};
    return reading;
  } catch (const FileProblem& problem) {
    return {{}, problem};
  }
}

TriangleReading read_triangles(const std::filesystem::path& file) {
  try {
    return read_triangle_text(read_bytes(file, max_triangle_bytes));
  } catch (const FileProblem& problem) {
    return {{}, problem};
  }
}

TriangleData read_stl(FileCursor& in) {
  TriangleData out;
  in.rest_of_line();  // "solid", and a name that may have blanks
  for (;;) {
    const std::string_view word = in.word("facet or endsolid");
    if (word == "endsolid") return out;
    if (word != "facet")
      in.fail("found '" + FileCursor::shortened(word) + "', expected facet or endsolid");
    in.keyword("normal");
    for (int k = 0; k < 3; ++k) in.word("a coordinate");  // often wrong, and not needed
    in.keyword("outer");
    in.keyword("loop");
    Vec3 corners[3];
    for (Vec3& p : corners) {
      in.keyword("vertex");
      p = read_point(in);
    }
    in.keyword("endloop");
    in.keyword("endfacet");
    add_triangle(out, corners);
  }
}

TriangleData read_stl_binary(std::string_view bytes) {
  TriangleData out;
  FileCursor in(bytes);
  in.swap_bytes = std::endian::native != std::endian::little;
  in.skip_bytes(80, "the header");
  const auto count = in.binary<std::uint32_t>("the number of triangles");
  for (std::uint32_t t = 0; t < count; ++t) {
    in.skip_bytes(12, "a normal");
    Vec3 corners[3];
    for (Vec3& p : corners)
      for (Real& x : p) {
        x = in.binary<float>("a coordinate");
        if (!std::isfinite(x)) in.fail_binary("a coordinate is not a finite number");
      }
    in.skip_bytes(2, "an attribute");
    add_triangle(out, corners);
  }
  return out;
}

/// A polygon becomes a fan of triangles. Numbers of points begin with 1; negative ones count back
/// from the last point so far. Normals, textures, groups and materials are not needed.
TriangleData read_obj(FileCursor& in) {
  TriangleData out;
  std::vector<Index> polygon;
  while (!in.peek().empty()) {
    const std::string_view word = in.word("a keyword");
    if (word == "v") {
      out.points.push_back(read_point(in));
      in.rest_of_line();  // a weight, a colour
    } else if (word != "f") {
      static constexpr std::string_view known[] = {"vt", "vn",     "vp",     "o", "g",
                                                   "s",  "usemtl", "mtllib", "l", "p"};
      if (word.front() != '#' &&
          std::find(std::begin(known), std::end(known), word) == std::end(known))
        in.fail("found '" + FileCursor::shortened(word) + "', expected a keyword of an OBJ file");
      in.rest_of_line();
    } else {
      const int line = in.line();
      FileCursor face(in.rest_of_line());
      polygon.clear();
      while (!face.peek().empty() && face.peek().front() != '#') {
        const std::string_view corner = face.word("a point");
        const std::string_view digits = corner.substr(0, corner.find('/'));
        long long number = 0;
        const auto [end, error] =
            std::from_chars(digits.data(), digits.data() + digits.size(), number);
        const auto points = static_cast<long long>(out.points.size());
        const long long index = number < 0 ? points + number : number - 1;
        if (error != std::errc{} || end != digits.data() + digits.size() || number == 0 ||
            index < 0 || index >= points)
          throw FileProblem{line, "found '" + FileCursor::shortened(corner) +
                                      "', expected one of the " + std::to_string(points) +
                                      " points so far"};
        polygon.push_back(index);
      }
      if (polygon.size() < 3)
        throw FileProblem{line, "a face of " + std::to_string(polygon.size()) +
                                    " points, expected three or more"};
      for (std::size_t k = 2; k < polygon.size(); ++k)
        out.triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
    }
  }
  return out;
}

}  // namespace sutura::contact
