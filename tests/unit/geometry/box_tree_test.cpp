#include "sutura/geometry/box_tree.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "count_allocations.h"

namespace sutura {
namespace {

struct Triangles {
  std::mt19937 random{5};
  std::vector<std::array<Vec3, 3>> items;
  explicit Triangles(int count) {
    for (int i = 0; i < count; ++i) {
      const Vec3 middle = point(1);
      items.push_back({middle + point(0.1), middle + point(0.1), middle + point(0.1)});
    }
  }
  Vec3 point(Real size) {
    std::uniform_real_distribution<Real> u(-size, size);
    const Real x = u(random), y = u(random), z = u(random);
    return {x, y, z};
  }
  std::vector<Vec3> centres() const {
    std::vector<Vec3> out;
    for (const auto& t : items) out.push_back((t[0] + t[1] + t[2]) / 3);
    return out;
  }
  Box box(Index i) const {
    Box b;
    for (const Vec3& p : items[static_cast<std::size_t>(i)]) b.add(p);
    return b;
  }
  void shake(Real size) {
    for (auto& t : items) {
      const Vec3 by = point(size);
      for (Vec3& p : t) p += by;
    }
  }
};

TEST(Box, MeetsWhatItTouches) {
  Box a, b;
  a.add(Vec3(0, 0, 0));
  a.add(Vec3(1, 1, 1));
  b.add(Vec3(1, 0.5, 0.5));
  b.add(Vec3(2, 2, 2));
  EXPECT_TRUE(a.meets(b));
  EXPECT_TRUE(b.meets(a));
  b.low.x() = 1.25;
  EXPECT_FALSE(a.meets(b));
  EXPECT_FALSE(b.meets(a));
  EXPECT_TRUE(a.grown(0.25).meets(b));  // 0.25 has exact digits
  EXPECT_FALSE(a.meets(Box{}));
}

// Whatever a box of the tree does not hold need not be asked: every item that meets the question is
// visited, after any motion, and of few items few are visited.
TEST(BoxTree, VisitsAllThatMeetABox) {
  Triangles world(500);
  const BoxTree tree(world.centres());
  BoxTree::Boxes boxes;
  long visited = 0, met = 0;
  for (int motion = 0; motion < 5; ++motion) {
    tree.refit(boxes, [&](Index i) { return world.box(i); });
    for (int question = 0; question < 200; ++question) {
      Box asked;
      asked.add(world.point(1));
      asked = asked.grown(0.1);
      std::set<Index> found;
      tree.visit(
          boxes, [&](const Box& b) { return b.meets(asked); },
          [&](Index i) { EXPECT_TRUE(found.insert(i).second) << "twice"; });
      visited += static_cast<long>(found.size());
      for (Index i = 0; i < 500; ++i) {
        if (!world.box(i).meets(asked)) continue;
        ++met;
        EXPECT_TRUE(found.count(i) > 0);
      }
    }
    world.shake(0.2);
  }
  EXPECT_GT(met, 1000);                // of 500 items and 1000 questions
  EXPECT_LT(visited, 1000 * 500 / 4);  // of all questions times all items
}

TEST(BoxTree, FirstBoxHoldsEverything) {
  Triangles world(37);
  const BoxTree tree(world.centres());
  BoxTree::Boxes boxes;
  tree.refit(boxes, [&](Index i) { return world.box(i); });
  Box all;
  for (Index i = 0; i < 37; ++i) all.add(world.box(i));
  EXPECT_EQ(boxes[0].low, all.low);
  EXPECT_EQ(boxes[0].high, all.high);
}

TEST(BoxTree, OfNothingAndOfOne) {
  const BoxTree nothing({});
  BoxTree::Boxes boxes;
  nothing.refit(boxes, [](Index) { return Box{}; });
  int visits = 0;
  const auto all = [](const Box&) { return true; };
  const auto count = [&](Index) { ++visits; };
  nothing.visit(boxes, all, count);
  EXPECT_EQ(visits, 0);
  const BoxTree one({Vec3::Zero()});
  one.refit(boxes, [](Index) { return Box{}; });
  one.visit(boxes, all, count);
  EXPECT_EQ(visits, 1);
}

#ifdef SUTURA_COUNTS_ALLOCATIONS
TEST(BoxTree, RefitsWithoutMemory) {
  Triangles world(300);
  const BoxTree tree(world.centres());
  BoxTree::Boxes boxes;
  tree.refit(boxes, [&](Index i) { return world.box(i); });
  world.shake(0.1);
  const long before = test::allocations();
  tree.refit(boxes, [&](Index i) { return world.box(i); });
  EXPECT_EQ(test::allocations(), before);
}
#endif

}  // namespace
}  // namespace sutura
