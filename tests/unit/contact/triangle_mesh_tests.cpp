// Surfaces of triangles: the same tetrahedron from every format, what is wrong with a file and
// where, distances against those of a box.
#include <gtest/gtest.h>

#include <random>

#include "read_triangles.h"
#include "shape.h"
#include "triangle_mesh.h"

namespace sutura::contact {
namespace {

const Vec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

template <class T>
void put(std::string& bytes, T value, bool swapped = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (swapped) std::reverse(std::begin(raw), std::end(raw));
  bytes.append(raw, sizeof(T));
}

std::string obj() {
  return "# a comment\no part\nv 0 0 0\nv 1 0 0 1.0\nv 0 1 0\nvn 0 0 1\nv 0 0 1\nusemtl steel\n"
         "f 1/1/1 3 2\nf 1 2 4 # and one more\nf -3 -2 -1\r\nf 1//1 4//1 3//1\n";
}
std::string stl() {
  std::string text = "solid a part with a name\n";
  for (const auto& f : faces) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const int i : f) {
      text += "   vertex";
      for (const Real x : corners[i]) text += " " + std::to_string(x);
      text += "\n";
    }
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid a part\n";
}
std::string stl_binary() {
  std::string bytes(80, ' ');
  bytes.replace(0, 5, "solid");  // as some programs write
  put(bytes, std::uint32_t{4});
  for (const auto& f : faces) {
    bytes.append(12, '\0');
    for (const int i : f)
      for (const Real x : corners[i]) put(bytes, static_cast<float>(x));
    put(bytes, std::uint16_t{0});
  }
  return bytes;
}
std::string ply(const std::string& format) {
  std::string out = "ply\nformat " + format +
                    " 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty float y\n"
                    "property float z\nproperty uchar red\nelement face 4\n"
                    "property list uchar int vertex_indices\nend_header\n";
  if (format == "ascii") {
    for (const Vec3& p : corners)
      out += std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) +
             " 255\n";
    for (const auto& f : faces)
      out += "3 " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " + std::to_string(f[2]) +
             "\n";
    return out;
  }
  const bool swapped =
      (format == "binary_big_endian") == (std::endian::native == std::endian::little);
  for (const Vec3& p : corners) {
    for (const Real x : p) put(out, static_cast<float>(x), swapped);
    put(out, std::uint8_t{255});
  }
  for (const auto& f : faces) {
    put(out, std::uint8_t{3});
    for (const int i : f) put(out, std::int32_t{i}, swapped);
  }
  return out;
}

TEST(Triangles, AreTheSameFromEveryFormat) {
  for (const std::string& bytes : {obj(), stl(), stl_binary(), ply("ascii"),
                                   ply("binary_little_endian"), ply("binary_big_endian")}) {
    const TriangleReading reading = read_triangle_text(bytes);
    ASSERT_FALSE(reading.problem) << reading.problem->line << ' ' << reading.problem->message;
    std::string error;
    const auto mesh = TriangleMesh::close(reading.data, error);
    ASSERT_TRUE(mesh) << error;
    EXPECT_EQ(mesh->points().size(), 4u);
    EXPECT_EQ(mesh->triangles().size(), 4u);
    EXPECT_NEAR(mesh->signed_distance(Vec3(0.1, 0.2, 0.3)), -0.1, 1e-12);
    EXPECT_NEAR(mesh->signed_distance(Vec3(0.1, 0.2, -0.3)), 0.3, 1e-12);
  }
}

struct Wrong {
  std::string bytes, message;
  int line;
};

TEST(Triangles, SayWhatIsWrongAndWhere) {
  const auto without = [](std::string text, const std::string& part, const std::string& instead) {
    return text.replace(text.find(part), part.size(), instead);
  };
  const std::string a = ply("ascii");
  const Wrong wrong[] = {
      {"", "the file is empty", 0},
      {"v 0 0 0\n", "there are no triangles", 0},
      {std::string("\x7f") + "ELF" + std::string(9, '\0'), "a binary file of another kind", 0},
      {"v 0 0 x\n", "found 'x', expected a coordinate", 1},
      {"v 0 0 1e999\n", "expected a coordinate", 1},
      {"v 0 0 nan\n", "expected a coordinate", 1},
      {"v 0 0", "the file ends where a coordinate", 1},
      {"hello\n", "found 'hello', expected a keyword of an OBJ file", 1},
      {"v 0 0 0\nv 1 0 0\nf 1 2 3\n", "found '3', expected one of the 2 points so far", 3},
      {"v 0 0 0\nf 1 1 0\n", "found '0'", 2},
      {"v 0 0 0\nf 1 1 -2\n", "found '-2'", 2},
      {"v 0 0 0\nf 1 1 99999999999999999999\n", "found '9999", 2},
      {"v 0 0 0\nf 1 1\n", "a face of 2 points", 2},
      {without(stl(), "vertex", "vertx"), "found 'vertx', expected 'vertex'", 4},
      {without(stl(), "endloop", "vertex 0 0 0"), "expected 'endloop'", 7},
      {without(stl(), "endsolid a part\n", ""), "the file ends where facet or endsolid", 30},
      {stl_binary() + "x", "", -1},
      {without(a, "ascii", "utf8"), "expected ascii, binary_little_endian", 2},
      {without(a, "property float x", "property flat x"), "found 'flat', expected a type", 5},
      {without(a, "element vertex 4", "element vertex 4000000000"), "bytes of the file are left",
       4},
      {without(a, "element vertex 4", "element vertex -4"), "the number of elements is -4", 4},
      {without(a, "element face 4", "element face 5"), "the file ends where", 20},
      {without(a, "3 0 2 1", "3 0 2 7"), "the number of a vertex is 7", 16},
      {without(a, "3 0 2 1", "3 0 2 1.5"), " is 1.5, expected a whole number below 4", 16},
      {without(a, "3 0 2 1", "2 0 2"), "a face of 2 points", 16},
      {without(a, "element vertex 4", "property float w"), "a property before any element", 4},
      {ply("binary_little_endian").substr(0, 260), "the file ends where", -1}};
  for (const Wrong& w : wrong) {
    const TriangleReading reading = read_triangle_text(w.bytes);
    ASSERT_TRUE(reading.problem) << w.message;
    EXPECT_NE(reading.problem->message.find(w.message), std::string::npos)
        << reading.problem->message << " instead of " << w.message;
    if (w.line >= 0) {
      EXPECT_EQ(reading.problem->line, w.line) << w.message;
    }
  }
}

TEST(Triangles, MustBeClosed) {
  const auto error_of = [](const std::string& text) {
    std::string error;
    EXPECT_FALSE(TriangleMesh::close(read_triangle_text(text).data, error));
    return error;
  };
  const std::string text = obj();
  EXPECT_NE(error_of(text.substr(0, text.rfind("f "))).find("is not closed: an edge at"),
            std::string::npos);
  EXPECT_NE(error_of(text + "f 1 2 3\n").find("has 3 triangles"), std::string::npos);
  std::string turned = text;
  turned.replace(turned.find("f 1/1/1 3 2"), 11, "f 1/1/1 2 3");
  EXPECT_NE(error_of(turned).find("face different sides"), std::string::npos);
}

// Whether it is written outside in or not.
TEST(Triangles, DistancesAreThoseOfABox) {
  for (const bool inside_out : {false, true}) {
    TriangleData data;
    for (int i = 0; i < 8; ++i)
      data.points.push_back(Vec3((i & 1) ? 2 : -2, (i & 2) ? 1 : -1, (i & 4) ? 0.5 : -0.5));
    constexpr Index quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                   {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& q : quads)
      for (int k = 2; k < 4; ++k) {
        data.triangles.push_back({q[0], q[k - 1], q[k]});
        if (inside_out) std::swap(data.triangles.back()[1], data.triangles.back()[2]);
      }
    std::string error;
    const auto mesh = TriangleMesh::close(data, error);
    ASSERT_TRUE(mesh) << error;
    const Shape box{.kind = Shape::Kind::box, .half_size = Vec3(2, 1, 0.5)};
    std::mt19937 random(1);
    std::uniform_real_distribution<Real> anywhere(-3, 3);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = Vec3::NullaryExpr([&] { return anywhere(random); });
      EXPECT_NEAR(mesh->signed_distance(p), box.at(p).distance, 1e-12) << p.transpose();
    }
  }
}

}  // namespace
}  // namespace sutura::contact
