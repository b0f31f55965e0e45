// A tool that is a mesh is the tool whose shape it has, however finely it is divided.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "contact_scenes.h"
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

/// A box of 10 x 8 x 4 mm, each side in n x n squares, as OBJ. Corners are written once per square.
std::string box_file(int n) {
  const std::string file = SUTURA_BINARY_DIR "/box_" + std::to_string(n) + ".obj";
  std::ofstream out(file);
  const Vec3 half(5, 4, 2);
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const int u = (axis + 1) % 3, v = (axis + 2) % 3;
          for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
            Vec3 p;
            p[axis] = side * half[axis];
            p[u] = half[u] * (2. * (i + a) / n - 1);
            p[v] = half[v] * (2. * (j + b) / n - 1);
            out << "v " << text_of(p) << '\n';
          }
          out << (side > 0 ? "f -4 -3 -2 -1\n" : "f -1 -2 -3 -4\n");
        }
  return file;
}

std::string mesh_tool(int n, const std::string& more) {
  return "<Tool name='tool' shape='mesh' unit='mm' file='" + box_file(n) + "' " + more + "/>";
}

// A thread falls across it and hangs over its edges.
TEST(MeshTool, HoldsAThreadAsABoxDoes) {
  const auto hung = [](const std::string& tool) {
    TextRun run(
        "<plugin name='contact'/>" +
            thread("a", Vec3(0, 0.3e-3, 5e-3), Vec3::UnitX(), 0.04, 40, "damping_mass='5 1/s'") +
            tool + "<Contact tool='tool' friction='0.3'/>",
        "dt='5 ms'");
    EXPECT_TRUE(run) << run.said();
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(run.simulation().step().solved) << i;
    EXPECT_GT(run.number("/contact", "touches"), 0);
    return std::pair(run.vector("/a", "tip_position"), run.vector("/tool", "force"));
  };
  const auto expected = hung("<Tool name='tool' shape='box' size='10 8 4 mm'/>");
  for (const int n : {1, 5}) {
    const auto found = hung(mesh_tool(n, ""));
    EXPECT_LT((found.first - expected.first).norm(), 1e-9) << n;  // the steps leave some 1e-10 m
    EXPECT_LT((found.second - expected.second).norm(), 1e-3 * expected.second.norm()) << n;
  }
}

/// A block of 10 x 30 mm with a gutter along y: two planes that fall towards x = z = 0 with
/// `slope`, as OBJ.
std::string gutter_file(Real slope) {
  const std::string file = SUTURA_BINARY_DIR "/gutter.obj";
  std::ofstream out(file);
  const Real high = 5 * std::tan(slope);
  for (const int y : {-15, 15})
    for (const Vec3& p :
         {Vec3(0, y, 0), Vec3(-5, y, high), Vec3(-5, y, -3), Vec3(5, y, -3), Vec3(5, y, high)})
      out << "v " << text_of(p) << '\n';
  out << "f 1 2 3\nf 1 3 4\nf 1 4 5\nf 8 7 6\nf 9 8 6\nf 10 9 6\n";
  for (int k = 1; k <= 5; ++k) {
    const int next = k % 5 + 1;
    out << "f " << k << ' ' << k + 5 << ' ' << next + 5 << ' ' << next << '\n';
  }
  return file;
}

// A thread slides to the bottom of a flat gutter and lies on both of its planes, however flat.
TEST(MeshTool, HoldsAThreadInAGutterOnBothSides) {
  constexpr Real radius = 0.1e-3;        // m
  for (const Real slope : {0.3, 0.1}) {  // rad
    TextRun run(
        "<plugin name='contact'/>" +
            thread("a", Vec3(0.3e-3, 0, 0.3e-3), Vec3::UnitY(), 0.02, 20, "damping_mass='20 1/s'") +
            "<Tool name='tool' shape='mesh' unit='mm' file='" + gutter_file(slope) +
            "'/><Contact tool='tool' friction='0'/>",
        "dt='5 ms'");
    ASSERT_TRUE(run) << run.said();
    for (int i = 0; i < 200; ++i) EXPECT_TRUE(run.simulation().step().solved) << i;
    // Gaps are solved to a micrometre.
    const Vec3 tip = run.vector("/a", "tip_position");
    EXPECT_NEAR(tip.x(), 0, 1e-6 / std::sin(slope)) << slope;
    EXPECT_NEAR(tip.z(), radius / std::cos(slope), 2e-6) << slope;
    EXPECT_EQ(run.number("/contact", "touches"), 2 * 21) << slope;
  }
}

// Pressed into tissue. What it touches are the nodes of the tissue, the same for both.
TEST(MeshTool, PressesTissueAlikeHoweverFineItIs) {
  const auto force = [](int n) {
    TextRun run("<plugin name='contact'/>" +
                    block("skin", "-12 -10 -8 12 10 0", "12 10 4",
                          "<Attach box='-12 -10 -8 12 10 -8 mm'/>") +
                    "<Track name='hand' times='0 0.2 s' positions='0 0 0  0 0 -1.1 mm'/>" +
                    mesh_tool(n, "centre='0 0 2.1 mm' motion='hand'") +
                    "<Contact first='/skin/tissue' tool='tool' friction='0.3'/>",
                "dt='10 ms' gravity='0 0 0'");
    EXPECT_TRUE(run) << run.said();
    for (int i = 0; i < 30; ++i) EXPECT_TRUE(run.simulation().step().solved) << i;
    const Vec3 on_tool = run.vector("/tool", "force");
    EXPECT_LT((on_tool + run.vector("/contact", "force")).norm(), 1e-12);
    return on_tool.z();
  };
  const Real coarse = force(1);
  EXPECT_GT(coarse, 0.1);
  // The direction of friction at single nodes is not determined better than steps are solved.
  EXPECT_NEAR(force(6), coarse, 0.01 * coarse);
}

/// A ball of 2 mm of 642 corners on it, an icosahedron of which every triangle is parted in four
/// three times, as OBJ.
std::string ball_file() {
  const std::string file = SUTURA_BINARY_DIR "/ball.obj";
  std::ofstream out(file);
  const Real golden = (1 + std::sqrt(5.)) / 2;
  std::vector<Vec3> corners;
  for (const Real a : {-1., 1.})
    for (const Real b : {-golden, golden}) {
      corners.push_back(Vec3(0, a, b));
      corners.push_back(Vec3(a, b, 0));
      corners.push_back(Vec3(b, 0, a));
    }
  const auto is_side = [&](const Vec3& a, const Vec3& b) { return (a - b).norm() < 2.1; };
  int written = 0;
  const auto write = [&](const auto& self, const Vec3& a, const Vec3& b, const Vec3& c,
                         int parts) -> void {
    if (parts == 0) {
      for (const Vec3& p : {a, b, c}) out << "v " << text_of(Vec3(2 * p.normalized())) << '\n';
      out << "f " << written + 1 << ' ' << written + 2 << ' ' << written + 3 << '\n';
      written += 3;
      return;
    }
    const Vec3 ab = (a + b).normalized(), bc = (b + c).normalized(), ca = (c + a).normalized();
    self(self, a, ab, ca, parts - 1);
    self(self, ab, b, bc, parts - 1);
    self(self, ca, bc, c, parts - 1);
    self(self, ab, bc, ca, parts - 1);
  };
  for (std::size_t i = 0; i < 12; ++i)
    for (std::size_t j = i + 1; j < 12; ++j)
      for (std::size_t k = j + 1; k < 12; ++k) {
        Vec3 a = corners[i], b = corners[j], c = corners[k];
        if (!is_side(a, b) || !is_side(b, c) || !is_side(c, a)) continue;
        if (a.dot(b.cross(c)) < 0) std::swap(b, c);
        write(write, a.normalized(), b.normalized(), c.normalized(), 3);
      }
  return file;
}

/// A bar along y with corners on a circle, and none but at its ends. Lengths in mm, as OBJ.
std::string bar_file(int sides, Real radius, Real length) {
  const std::string file = SUTURA_BINARY_DIR "/bar_" + std::to_string(sides) + ".obj";
  std::ofstream out(file);
  std::string faces, first = "f", last;
  for (int k = 0; k < sides; ++k) {
    const Real angle = 2 * std::numbers::pi * k / sides;
    const Real x = radius * std::sin(angle), z = radius * std::cos(angle);
    for (const Real y : {-length / 2, length / 2}) out << "v " << text_of(Vec3(x, y, z)) << '\n';
    const std::string at = ' ' + std::to_string(2 * k + 1), to = ' ' + std::to_string(2 * k + 2);
    const int next = (k + 1) % sides;
    faces += 'f' + at + to + ' ' + std::to_string(2 * next + 2) + ' ' +
             std::to_string(2 * next + 1) + '\n';
    first += at;
    last = to + last;
  }
  out << faces << first << "\nf" << last << '\n';
  return file;
}

struct Pressed {
  Real force, distance;  // N, m
};

/// Into a block whose elements are as large as the tool, between its nodes.
Pressed pressed_in(const std::string& shape, Real height, Real way, Real cell) {
  const int cells = static_cast<int>(20 / cell);
  TextRun run("<plugin name='contact'/>" +
                  block("skin", "-10 -10 -5 10 10 0",
                        std::to_string(cells) + ' ' + std::to_string(cells) + " 2",
                        "<Attach box='-10 -10 -5 10 10 -5 mm'/>") +
                  "<Track name='hand' times='0 0.3 s' positions='0 0 0  0 0 " +
                  std::to_string(-way) + " mm'/><Tool name='tool' centre='0.9 0.35 " +
                  std::to_string(height) + " mm' motion='hand' " + shape +
                  "/><Contact first='/skin/tissue' tool='tool'/>",
              "dt='10 ms' gravity='0 0 0'");
  EXPECT_TRUE(run) << run.said();
  for (int i = 0; i < 40; ++i) EXPECT_TRUE(run.simulation().step().solved) << i;
  return {run.vector("/tool", "force").z(), run.number("/contact", "distance")};
}

// Where the tissue has no node below it, the tool's own nodes are what is pressed. The first one
// near a node of the tissue let all of them in: a ball sank by 1 mm without a force.
TEST(MeshTool, IsFeltBetweenTheNodesOfATissue) {
  const std::string mesh = "shape='mesh' unit='mm' file='";
  for (const Real cell : {4., 2.}) {
    const Pressed ball = pressed_in(mesh + ball_file() + "'", 2.1, 1.1, cell);
    const Pressed sphere = pressed_in("shape='sphere' radius='2 mm'", 2.1, 1.1, cell);
    // Its corners are on the sphere, its triangles up to 1 % of the radius within.
    EXPECT_NEAR(ball.force, sphere.force, 0.02 * sphere.force) << cell;
    EXPECT_GT(ball.distance, -1e-6) << cell;
    const Pressed bar = pressed_in(mesh + bar_file(24, 0.5, 30) + "'", 0.6, 0.4, cell);
    const Pressed capsule =
        pressed_in("shape='capsule' radius='0.5 mm' length='29 mm' axis='0 1 0'", 0.6, 0.4, cell);
    EXPECT_NEAR(bar.force, capsule.force, 0.02 * capsule.force) << cell;
    EXPECT_GT(bar.distance, -1e-6) << cell;
    // The end of something slender: its sides are larger than that by far. Its corners are up to
    // 0.03 mm aside of where the bead is, where a dent of 0.5 mm is up to 2 % less deep.
    const Pressed rod =
        pressed_in(mesh + bar_file(4, 0.03, 3) + "' rotation='90 0 0 deg'", 1.6, 0.6, cell);
    const Pressed bead = pressed_in("shape='sphere' radius='0.03 mm'", 0.13, 0.6, cell);
    EXPECT_NEAR(rod.force, bead.force, 0.02 * bead.force) << cell;
    EXPECT_GT(rod.distance, -1e-6) << cell;
  }
}

TEST(MeshTool, SaysWhatIsWrong) {
  const auto said = [](const std::string& tool) {
    TextRun run("<plugin name='contact'/>" +
                thread("a", Vec3(0, 0, 5e-3), Vec3::UnitX(), 0.02, 10) + tool +
                "<Contact tool='tool'/>");
    EXPECT_FALSE(run);
    return run.said();
  };
  EXPECT_NE(said("<Tool name='tool' shape='mesh'/>").find("mesh file"), std::string::npos);
  EXPECT_NE(said("<Tool name='tool' shape='mesh' file='hok.obj'/>").find("no such file"),
            std::string::npos);
  EXPECT_NE(said("<Tool name='tool' shape='box' file='hook.obj'/>").find("expected shape=\"mesh\""),
            std::string::npos);
  const std::string file = SUTURA_BINARY_DIR "/wrong.obj";
  std::ofstream(file) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n";
  EXPECT_NE(said("<Tool name='tool' shape='mesh' file='" + file + "'/>").find("wrong.obj:4"),
            std::string::npos);
  std::ofstream(file) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_NE(said("<Tool name='tool' shape='mesh' file='" + file + "'/>").find("not closed"),
            std::string::npos);
}

}  // namespace
}  // namespace sutura::testing
