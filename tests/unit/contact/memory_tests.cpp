// Who is who among touches, from pass to pass and from step to step.
#include <gtest/gtest.h>

#include "contact_memory.h"

namespace sutura::contact {
namespace {

/// Touches are found again within half a unit.
struct Near : Pair {
  void look_for_touches(const TouchedPlaces&, std::vector<Touch>&) override {}
  Real built_from(const Touch&) const override { return 1; }
  Vec3 slip(const Touch&) const override { return Vec3::Zero(); }
  void couple(const Touch&, BlockId, const Directions&, ConstraintBuilder&) const override {}
  Real distance() const override { return 0; }
  Tolerance tolerance(const Touch&) const override { return {0.5, 0.5}; }
};

std::vector<Touch> touches(const std::vector<std::pair<Real, Real>>& places) {
  std::vector<Touch> out;
  for (const auto& [first, second] : places) {
    Touch& t = out.emplace_back();
    t.first_place = first;
    t.second_place = second;
  }
  return out;
}

TEST(ContactMemory, KnowsWhatItHasMetInThisStep) {
  ContactMemory memory;
  memory.begin_step();
  auto now = touches({{3, 0}, {1, 0}, {1, 7}});
  memory.recognise(now, Near());
  EXPECT_NE(now[1].id, now[2].id);  // the same place on the first, another on the second
  auto later = touches({{1.2, 7.1}, {3.1, 0}, {5, 0}, {1.2, -0.2}});
  memory.recognise(later, Near());
  EXPECT_EQ(later[0].id, now[2].id);
  EXPECT_EQ(later[1].id, now[0].id);
  EXPECT_EQ(later[3].id, now[1].id);
  for (const Touch& t : now) EXPECT_NE(later[2].id, t.id);
  // One that was not found for a pass is known in the next.
  auto fewer = touches({{5, 0}});
  memory.recognise(fewer, Near());
  auto again = touches({{3.1, 0.1}});
  memory.recognise(again, Near());
  EXPECT_EQ(again[0].id, now[0].id);
  EXPECT_DOUBLE_EQ(memory.between(4, 6), 5);
  EXPECT_TRUE(std::isnan(memory.between(5, 6)));
}

// Touches that move by nearly the tolerance, each to where the next one was a moment ago: the
// order in which they are looked for must not matter.
TEST(ContactMemory, TouchesThatMoveTogetherKeepTheirNames) {
  ContactMemory memory;
  memory.begin_step();
  std::vector<std::pair<Real, Real>> places;
  for (int i = 0; i < 20; ++i) places.emplace_back(i, 0);
  auto now = touches(places);
  memory.recognise(now, Near());
  for (int pass = 0; pass < 10; ++pass) {
    for (auto& [first, second] : places) first += 0.45;
    auto later = touches(places);
    memory.recognise(later, Near());
    for (std::size_t i = 0; i < now.size(); ++i) EXPECT_EQ(later[i].id, now[i].id) << pass;
  }
}

// A touch that is new and comes first does not take the name of one that is still there.
TEST(ContactMemory, WhoIsNearestKeepsTheName) {
  for (const bool new_one_first : {true, false}) {
    ContactMemory memory;
    memory.begin_step();
    auto now = touches({{1, 0}});
    memory.recognise(now, Near());
    auto later = new_one_first ? touches({{0.6, 0}, {1, 0}}) : touches({{1, 0}, {0.6, 0}});
    memory.recognise(later, Near());
    EXPECT_EQ(later[new_one_first ? 1 : 0].id, now[0].id);
    EXPECT_NE(later[new_one_first ? 0 : 1].id, now[0].id);
  }
}

TEST(ContactMemory, KnowsWhoIsMissing) {
  ContactMemory memory;
  memory.begin_step();
  auto now = touches({{1, 0}, {3, 2}});
  memory.recognise(now, Near());
  auto fewer = touches({{1.1, 0}});
  memory.recognise(fewer, Near());
  int missing = 0;
  memory.each_missing([&](const ContactMemory::Known& known) {
    ++missing;
    EXPECT_EQ(known.id, now[1].id);
    EXPECT_EQ(known.first, 3);
    EXPECT_EQ(known.second, 2);
  });
  EXPECT_EQ(missing, 1);
}

TEST(ContactMemory, OnlyWhatCarriesIsKnownInTheNextStep) {
  ContactMemory memory;
  memory.begin_step();
  auto now = touches({{1, 0}, {-2, 0}});
  memory.recognise(now, Near());
  now[1].carries = true;
  now[1].left_over = Vec2(1e-7, 0);
  memory.remember(now, Near());
  memory.begin_step();
  auto next = touches({{1, 0}, {-2, 0}});
  memory.recognise(next, Near());
  EXPECT_NE(next[0].id, now[0].id);
  EXPECT_EQ(next[1].id, now[1].id);
  EXPECT_EQ(next[1].left_over, Vec2(1e-7, 0));
}

}  // namespace
}  // namespace sutura::contact
