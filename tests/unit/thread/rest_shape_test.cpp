// A helix against its closed form, and files of rest shapes, good and bad.
#include "rest_shape.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace sutura::thread {
namespace {

TEST(RestShape, IsTheHelixOfItsCurvatureAndTorsion) {
  const Real k = 200, t = 150;  // 1/m
  const RestShape shape(std::vector<RestPiece>{{0, k, t}});
  // Radius and pitch of a helix: r = k / (k^2 + t^2), rise per radian b = t / (k^2 + t^2).
  const Real w = std::sqrt(k * k + t * t), r = k / (w * w), b = t / (w * w);
  for (const Real s : {0., 1e-6, 1e-3, 0.02, 0.1}) {
    // Distance between two points of a helix that lie s apart along it.
    const Real chord = std::hypot(2 * r * std::sin(w * s / 2), b * w * s);
    EXPECT_NEAR(shape.at({}, s).position.norm(), chord, 1e-15 + 1e-12 * chord);
  }
  // It advances along its own axis, whichever that is, by b w per length.
  const Real turn = 2 * std::numbers::pi / w;
  EXPECT_NEAR((shape.at({}, 3 * turn).position - shape.at({}, 2 * turn).position).norm(),
              b * w * turn, 1e-12);
}

TEST(RestShape, PiecesFollowEachOther) {
  // A quarter circle of 10 mm radius, then straight on: it bends towards minus y.
  const Real quarter = 0.01 * std::numbers::pi / 2;
  const RestShape shape(std::vector<RestPiece>{{0, 100, 0}, {quarter, 0, 0}});
  EXPECT_LT((shape.at({}, quarter).position - Vec3(0.01, -0.01, 0)).norm(), 1e-14);
  EXPECT_LT((shape.at({}, quarter + 0.005).position - Vec3(0.01, -0.015, 0)).norm(), 1e-14);
}

// Two curvatures across each other bend about the axis between them, and twist nothing: half a
// circle ends across the plane in which it lies.
TEST(RestShape, BendsToAnySideWithoutTwist) {
  const Real k = 100, a = 0.7, half = std::numbers::pi / k;
  const RestShape shape(std::vector<RestPiece>{{0, k * std::cos(a), 0, k * std::sin(a)}});
  const Pose end = shape.at({}, half);
  EXPECT_LT((end.position - 2 / k * Vec3(0, -std::cos(a), -std::sin(a))).norm(), 1e-14);
  const Vec3 axis(0, std::sin(a), -std::cos(a));
  EXPECT_LT((end.rotation * axis - axis).norm(), 1e-14);
}

class RestFile : public ::testing::Test {
 protected:
  std::vector<RestPiece> read(const std::string& text) {
    // A name of its own: tests run beside each other.
    const auto file = std::filesystem::temp_directory_path() /
                      ("sutura_rest_shape_" + std::to_string(getpid()) + ".csv");
    std::ofstream(file) << text;
    auto pieces = read_rest_shape(file, line_, error_);
    std::filesystem::remove(file);
    return pieces;
  }
  int line_ = 0;
  std::string error_;
};

TEST_F(RestFile, IsRead) {
  const auto pieces = read("# a coil\ntorsion [1/mm], s [mm], curvature\n0, 0, 5\n0.001, 20, 7\n");
  ASSERT_EQ(pieces.size(), 2u) << error_;
  EXPECT_EQ(pieces[1].from, 0.02);
  EXPECT_EQ(pieces[1].curvature, 7);
  EXPECT_EQ(pieces[1].torsion, 1);
  EXPECT_EQ(pieces[1].side_curvature, 0);
  EXPECT_EQ(read("s, curvature, side_curvature [1/mm]\n0, 1, 2\n")[0].side_curvature, 2000);
}

TEST_F(RestFile, ThatIsMalformedIsRefusedWithItsLine) {
  struct Bad {
    const char* text;
    int line;
    const char* words;
  };
  for (const auto& [text, line, words] :
       {Bad{"", 0, "no rows"}, Bad{"s [mm], curvature [1/m]\n", 0, "no rows"},
        Bad{"s [mm], bend [1/m]\n0, 1\n", 1, "'bend [1/m]' is no column"},
        Bad{"curvature\n1\n", 1, "s and curvature once"},
        Bad{"s, curvature, curvature\n0, 1, 1\n", 1, "once"},
        Bad{"s, curvature\n1, 2\n", 2, "first row must be at s = 0"},
        Bad{"s, curvature\n0, 2\n0, 3\n", 3, "does not increase"},
        Bad{"s, curvature\n0, 2, 3\n", 2, "3 numbers"}, Bad{"s, curvature\n0, x\n", 2, "x"},
        Bad{"s, curvature\n0, nan\n", 2, "nan"}, Bad{"s [kg], curvature\n0, 1\n", 2, "kg"}}) {
    EXPECT_TRUE(read(text).empty()) << text;
    EXPECT_EQ(line_, line) << text;
    EXPECT_NE(error_.find(words), std::string::npos) << text << " -> " << error_;
  }
  EXPECT_TRUE(read_rest_shape("/nowhere/at/all.csv", line_, error_).empty());
  EXPECT_NE(error_.find("cannot read"), std::string::npos);
}

}  // namespace
}  // namespace sutura::thread
