// A thread that begins sewn: the channel that its needle would have made, where the thread lies.
#include <gtest/gtest.h>

#include "channel.h"
#include "fake_bodies.h"

namespace sutura::testing {

using namespace suturing;

namespace {

constexpr Real mm = 1e-3;
constexpr Real nm = 1e-9;  // to which mouths are found

/// Straight along -z through a slab from z = 0 to -20 mm.
class SewnTest : public ::testing::Test {
 protected:
  SewnTest() {
    slab.thickness = 20 * mm;
    needle.length_ = 40 * mm;
  }
  RigidNeedle needle;
  SpringSlab slab;
  Channel channel{needle, slab, 1 * mm};
};

TEST_F(SewnTest, AThreadLiesInTheChannelThatItsNeedleWouldHaveMade) {
  needle.now_ = 0.1 * mm;
  Channel made(needle, slab, 1 * mm);
  made.enter(SpringSlab::embedded(Vec3::Zero()));
  for (Real depth = 1; depth < 20; depth += 0.7) {
    needle.now_ = depth * mm;
    made.update(false);
  }
  needle.now_ = 20.05 * mm;
  made.update(false);
  made.leave(SpringSlab::embedded(Vec3(0, 0, -20 * mm)));
  needle.now_ = 30.3 * mm;
  made.update(false);

  ASSERT_EQ(channel.sew(), "");
  ASSERT_EQ(channel.passed(), made.passed());
  EXPECT_FALSE(channel.tip_inside());
  EXPECT_NEAR(channel.inserted_length(), 20 * mm, 2 * nm);
  for (std::size_t i = 0; i < made.passed(); ++i) {
    const PathSample &s = channel.samples()[i], &m = made.samples()[i];
    EXPECT_EQ(s.kind, m.kind);
    EXPECT_NEAR(s.abscissa, m.abscissa, nm);
    EXPECT_NEAR(s.depth, m.depth, nm);
    EXPECT_EQ(s.slip, 0);
    const Vec3 off = slab.position(s.at, Configuration::current) -
                     needle.point(s.abscissa, Configuration::current);
    EXPECT_LT(off.norm(), nm);  // on the thread: nothing is strained
  }
  // And it goes on as that one does: drawn through until its end has left the tissue.
  for (const Real travel : {35.0, 45.5, 61.0}) {
    needle.now_ = travel * mm;
    channel.update(false);
    made.update(false);
    EXPECT_EQ(channel.passed(), made.passed());
    EXPECT_NEAR(channel.inserted_length(), made.inserted_length(), 2 * nm);
  }
  EXPECT_EQ(channel.passed(), 0u);
}

TEST_F(SewnTest, WhatIsNotSewnIsToldFromWhatIs) {
  needle.now_ = 10 * mm;
  EXPECT_EQ(channel.sew(), "its tip is in the tissue");
  needle.now_ = 50 * mm;
  EXPECT_EQ(channel.sew(), "its end is in the tissue");
  needle.now_ = -5 * mm;
  EXPECT_EQ(channel.sew(), "no part of it goes through the tissue");
  EXPECT_EQ(channel.passed(), 0u);
}

}  // namespace
}  // namespace sutura::testing
