// Signed distances of the rigid shapes against their definition.
#include <gtest/gtest.h>

#include <random>

#include "shape.h"

namespace sutura::contact {
namespace {

const std::vector<Shape>& shapes() {
  static const std::vector<Shape> all{
      {.kind = Shape::Kind::plane},
      {.kind = Shape::Kind::sphere, .radius = 2},
      {.kind = Shape::Kind::capsule, .radius = 0.7, .half_length = 1.5},
      {.kind = Shape::Kind::cylinder, .radius = 1.2, .half_length = 0.8},
      {.kind = Shape::Kind::box, .half_size = Vec3(1, 0.5, 2)},
      {.kind = Shape::Kind::box, .half_size = Vec3(1, 0.5, 2), .rounding = 0.1},
      {.kind = Shape::Kind::box, .half_size = Vec3(1, 0.5, 2), .rounding = 0.5}};
  return all;
}

// What makes a signed distance: its gradient is the normal, and walking back by it leads to the
// surface, whichever side one comes from.
TEST(Shape, TheNormalIsTheGradientAndLeadsToTheSurface) {
  std::mt19937 random(3);
  std::uniform_real_distribution<Real> anywhere(-3, 3);
  for (const Shape& shape : shapes()) {
    int near_edges = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p(anywhere(random), anywhere(random), anywhere(random));
      const ShapeDistance d = shape.at(p);
      EXPECT_NEAR(d.normal.norm(), 1, 1e-12);
      EXPECT_NEAR(shape.at(p - d.distance * d.normal).distance, 0, 1e-12);
      constexpr Real h = 1e-6;
      Vec3 gradient;
      for (int k = 0; k < 3; ++k)
        gradient[k] =
            (shape.at(p + h * Vec3::Unit(k)).distance - shape.at(p - h * Vec3::Unit(k)).distance) /
            (2 * h);
      // Inside there are places as near to one face as to another, where it has a crease.
      if (d.distance < 0 && (gradient - d.normal).norm() > 1e-6)
        ++near_edges;
      else
        EXPECT_LT((gradient - d.normal).norm(), 1e-5);
    }
    EXPECT_LT(near_edges, 5);
  }
}

TEST(Shape, KnownDistances) {
  EXPECT_NEAR(shapes()[0].at(Vec3(5, 5, -0.3)).distance, -0.3, 1e-15);
  EXPECT_NEAR(shapes()[1].at(Vec3(0, 3, 4)).distance, 3, 1e-15);
  EXPECT_NEAR(shapes()[2].at(Vec3(0, 0, 3)).distance, 0.8, 1e-15);
  EXPECT_NEAR(shapes()[3].at(Vec3(1.5, 0, 1.2)).distance, 0.5, 1e-15);  // a 3-4-5 triangle
  EXPECT_NEAR(shapes()[4].at(Vec3(2, 1.5, 0)).distance, std::sqrt(2), 1e-15);
  EXPECT_NEAR(shapes()[4].at(Vec3(0.2, 0.4, 0)).distance, -0.1, 1e-15);
  // Rounded: faces stay where they are, an edge is a circle.
  EXPECT_NEAR(shapes()[5].at(Vec3(0.2, 0.9, 1)).distance, 0.4, 1e-15);
  EXPECT_NEAR(shapes()[5].at(Vec3(0.2, 0.4, 0)).distance, -0.1, 1e-15);
  EXPECT_NEAR(shapes()[5].at(Vec3(1.2, 0.7, 0)).distance, 0.3 * std::sqrt(2) - 0.1, 1e-15);
}

// What is left without a layer is inside of the shape, by the layer at least; of all its points the
// one that is asked for is the nearest.
TEST(Shape, TheCoreIsBelowTheLayer) {
  std::mt19937 random(7);
  std::uniform_real_distribution<Real> anywhere(-3, 3);
  const auto point = [&] { return Vec3(anywhere(random), anywhere(random), anywhere(random)); };
  for (const Shape& shape : shapes()) {
    if (shape.kind == Shape::Kind::plane) continue;
    const Real layer = shape.half_thickness() / 3;
    for (int i = 0; i < 1000; ++i) {
      const Vec3 p = point(), core = shape.core(p, layer), other = shape.core(point(), layer);
      EXPECT_LE(shape.at(core).distance, -layer + 1e-12);
      EXPECT_LE((p - core).norm(), (p - other).norm() + 1e-12);
    }
  }
}

// The way of a curve may be judged by one plane only because every shape is convex.
TEST(Shape, IsConvex) {
  std::mt19937 random(5);
  std::uniform_real_distribution<Real> anywhere(-3, 3);
  for (const Shape& shape : shapes())
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p(anywhere(random), anywhere(random), anywhere(random));
      const Vec3 q(anywhere(random), anywhere(random), anywhere(random));
      EXPECT_LE(shape.at((p + q) / 2).distance,
                (shape.at(p).distance + shape.at(q).distance) / 2 + 1e-12);
    }
}

// What faces a point outside, seen from what is left without a layer, is what `facet` says where
// that is a face, and passes through the edge or corner itself where it is one.
TEST(Shape, FacesAPointThroughTheEdgeItIsBelow) {
  const Shape box{.kind = Shape::Kind::box, .half_size = Vec3(1, 0.5, 2)};
  const Shape rod{.kind = Shape::Kind::cylinder, .radius = 1.2, .half_length = 0.8};
  const auto expect = [](const Facet& f, const Vec3& normal, const Vec3& foot) {
    EXPECT_LT((f.normal - normal).norm(), 1e-12);
    EXPECT_NEAR(f.normal.dot(f.foot - foot), 0, 1e-12);
  };
  const Real half = std::sqrt(0.5), third = std::sqrt(1. / 3);
  expect(box.facing(Vec3(1.3, 0.1, -0.4), 0.1), Vec3::UnitX(), Vec3(1, 0, 0));
  expect(box.facing(Vec3(1.2, 0.7, 0.3), 0.1), Vec3(half, half, 0), Vec3(1, 0.5, 0.3));
  expect(box.facing(Vec3(1, 0.5, -2), 0.1), Vec3(third, third, -third), Vec3(1, 0.5, -2));
  // Inside of the tool, within the layer, it is still the edge.
  expect(box.facing(Vec3(0.95, 0.45, 0), 0.1), Vec3(half, half, 0), Vec3(1, 0.5, 0));
  expect(rod.facing(Vec3(0, 1.4, 1), 0.1), Vec3(0, half, half), Vec3(0, 1.2, 0.8));
  expect(rod.facing(Vec3(0, 0.3, 1), 0.1), Vec3::UnitZ(), Vec3(0, 0, 0.8));
}

}  // namespace
}  // namespace sutura::contact
