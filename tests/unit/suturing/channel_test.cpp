// The channel: made by an advancing tip, left by a retracting one, found again, emptied by the end
// of the thread.
#include "channel.h"

#include <gtest/gtest.h>

#include "fake_bodies.h"

namespace sutura::testing {

using namespace suturing;

namespace {

constexpr Real mm = 1e-3;

class ChannelTest : public ::testing::Test {
 protected:
  ChannelTest() {
    slab.thickness = 20 * mm;
    needle.length_ = 40 * mm;
  }
  void move_to(Real depth) {
    needle.now_ = depth;
    channel.update(false);
  }
  EmbeddedPoint top() const { return SpringSlab::embedded(Vec3(needle.sideways, 0, 0)); }
  EmbeddedPoint bottom() const { return SpringSlab::embedded(Vec3(needle.sideways, 0, -20 * mm)); }

  RigidNeedle needle;
  SpringSlab slab;
  Channel channel{needle, slab, 1 * mm};
};

TEST_F(ChannelTest, EnteringRecordsWhatTheTipHasPassed) {
  needle.now_ = 2.5 * mm;
  channel.enter(top());
  // Entry, 1 mm, 2 mm: the end at 2.5 mm is no sample yet.
  ASSERT_EQ(channel.passed(), 3u);
  EXPECT_TRUE(channel.tip_inside());
  EXPECT_TRUE(channel.tip_at_end());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(channel.samples()[i].depth, Real(i) * mm, 1e-15);
    EXPECT_NEAR(channel.samples()[i].abscissa, (2.5 - Real(i)) * mm, 1e-15);
  }
  EXPECT_NEAR(channel.tip_depth(), 2.5 * mm, 1e-15);
}

TEST_F(ChannelTest, LengthsAddUpToWhatIsInside) {
  needle.now_ = 0.3 * mm;
  channel.enter(top());
  for (const Real depth : {0.9, 1.7, 4.2, 4.3, 9.9}) {
    move_to(depth * mm);
    EXPECT_NEAR(channel.inserted_length(), depth * mm, 1e-15);
  }
  EXPECT_EQ(channel.passed(), 10u);  // the entry and one each millimetre
}

TEST_F(ChannelTest, RetractionLeavesSamplesAndReinsertionFindsThem) {
  needle.now_ = 0.1 * mm;
  channel.enter(top());
  move_to(8.4 * mm);
  const auto id = channel.samples()[8].id;
  const Real end = channel.end_depth();
  move_to(3.4 * mm);
  EXPECT_EQ(channel.passed(), 4u);
  EXPECT_FALSE(channel.tip_at_end());
  EXPECT_NEAR(channel.end_depth(), end, 1e-15) << "what has been cut stays cut";
  for (Real depth = 3.4; depth < 8.3; depth += 0.3) move_to(depth * mm);
  EXPECT_FALSE(channel.tip_at_end());
  move_to(8.7 * mm);
  EXPECT_EQ(channel.samples()[8].id, id) << "the old channel, not a new one";
  EXPECT_EQ(channel.passed(), 9u);
  EXPECT_TRUE(channel.tip_at_end());
}

TEST_F(ChannelTest, OutAndInAgainThroughTheSameMouthNeedsNoPuncture) {
  needle.now_ = 0.1 * mm;
  channel.enter(top());
  move_to(3.2 * mm);
  move_to(-0.4 * mm);  // within two radii of 0.25 mm
  EXPECT_EQ(channel.passed(), 0u);
  EXPECT_FALSE(channel.tip_inside());
  EXPECT_TRUE(channel.mouth_near(needle.point(0, Configuration::current)));
  move_to(0.4 * mm);
  EXPECT_TRUE(channel.tip_inside());
  EXPECT_FALSE(channel.tip_at_end());
}

/// A tip on a dented mesh stands before the surface that it has pierced.
TEST_F(ChannelTest, ATipThatHasPiercedIsHeldFromWhereItStood) {
  needle.now_ = -0.1 * mm;
  channel.enter(top());
  for (const Real depth : {-0.1, -0.02, -0.1}) {
    move_to(depth * mm);
    EXPECT_TRUE(channel.tip_inside()) << depth;
    EXPECT_NEAR(channel.tip_depth(), depth * mm, 1e-15);
    EXPECT_FALSE(channel.tip_at_end()) << "it has not come to the mouth yet";
    EXPECT_EQ(channel.inserted_length(), 0);
  }
  move_to(0.3 * mm);
  EXPECT_NEAR(channel.tip_depth(), 0.3 * mm, 1e-15);
  EXPECT_TRUE(channel.tip_at_end());
  move_to(-0.09 * mm);
  EXPECT_TRUE(channel.tip_inside());
  move_to(-0.11 * mm);
  EXPECT_FALSE(channel.tip_inside()) << "further back than it was";
}

TEST_F(ChannelTest, OnceThereIsAChannelBehindItTheTipIsOutBeforeTheMouth) {
  needle.now_ = -0.1 * mm;
  channel.enter(top());
  move_to(1.2 * mm);
  ASSERT_EQ(channel.passed(), 2u);
  move_to(-0.01 * mm);
  EXPECT_FALSE(channel.tip_inside());
}

TEST_F(ChannelTest, ElsewhereTheOldMouthDoesNotHelpAndANewBiteForgetsIt) {
  needle.now_ = 0.1 * mm;
  channel.enter(top());
  move_to(3.2 * mm);
  move_to(-0.5 * mm);
  needle.sideways = 5 * mm;
  move_to(0.4 * mm);
  EXPECT_FALSE(channel.tip_inside());
  EXPECT_FALSE(channel.mouth_near(needle.point(0, Configuration::current)));
  channel.enter(top());
  EXPECT_TRUE(channel.tip_inside());
  EXPECT_EQ(channel.samples().size(), 1u);
}

TEST_F(ChannelTest, ThroughAndOutTheThreadLeavesTheChannelEmpty) {
  needle.now_ = 0.1 * mm;
  channel.enter(top());
  move_to(19.6 * mm);
  // Hardly through, it may still be tenting the surface: only the puncture knows that it is out.
  move_to(20.05 * mm);
  EXPECT_TRUE(channel.tip_inside());
  channel.leave(bottom());
  EXPECT_FALSE(channel.tip_inside());
  EXPECT_NEAR(channel.inserted_length(), 20 * mm, 1e-12);
  EXPECT_EQ(channel.samples().back().kind, PathSample::Kind::exit);
  EXPECT_NEAR(channel.samples().back().abscissa, 0.05 * mm, 1e-12);
  move_to(35 * mm);
  EXPECT_NEAR(channel.inserted_length(), 20 * mm, 1e-12);
  // The thread is 40 mm long: at 45 mm of travel its end is 5 mm deep, at 61 mm it is out.
  move_to(45 * mm);
  EXPECT_NEAR(channel.samples().front().depth, 5 * mm, 1 * mm);
  move_to(61 * mm);
  EXPECT_EQ(channel.passed(), 0u);
  EXPECT_EQ(channel.inserted_length(), 0);
}

TEST_F(ChannelTest, ATipWellOutHasLeftWithoutAPuncture) {
  needle.now_ = 0.1 * mm;
  channel.enter(top());
  move_to(19.6 * mm);
  move_to(20.5 * mm);
  EXPECT_TRUE(channel.tip_inside());  // it may be tenting
  move_to(21.5 * mm);                 // further than samples are apart
  EXPECT_FALSE(channel.tip_inside());
}

/// The motion of a tent is no channel; what the tip goes along the surface that holds it is one.
TEST_F(ChannelTest, ABlockedTipRecordsItsWayAlongTheSurface) {
  needle.now_ = 0.1 * mm;
  channel.enter(top());
  move_to(2.1 * mm);
  ASSERT_EQ(channel.passed(), 3u);
  needle.now_ = 4.3 * mm;
  channel.update(true);
  EXPECT_EQ(channel.passed(), 3u);
  EXPECT_NEAR(channel.end_depth(), 2.1 * mm, 1e-15);
  channel.update(true, Vec3::UnitX());  // nothing of its motion was along that
  EXPECT_EQ(channel.passed(), 3u);
  const Vec3 along = Vec3(1, 0, -3).normalized();
  channel.update(true, along);
  EXPECT_EQ(channel.passed(), 5u);
  EXPECT_NEAR(channel.end_depth(), 4.3 * mm, 1e-15);
  // Back along the surface it leaves what it has cut there.
  needle.now_ = 3.5 * mm;
  channel.update(true, along);
  EXPECT_EQ(channel.passed(), 4u);
  EXPECT_FALSE(channel.tip_at_end());
}

TEST_F(ChannelTest, PullingTheTipBackThroughTheExitIsInsideAgain) {
  needle.now_ = 0.1 * mm;
  channel.enter(top());
  move_to(19.6 * mm);
  move_to(20.5 * mm);
  move_to(18 * mm);
  EXPECT_TRUE(channel.tip_inside());
  EXPECT_NEAR(channel.inserted_length(), 18 * mm, 1e-12);
}

/// The thread is at (sideways, 0) in a slab that ends at x = 2 mm.
class CutOutOfChannel : public ChannelTest {
 protected:
  CutOutOfChannel() {
    slab.side = 2 * mm;
    needle.now_ = 0.1 * mm;
    channel.enter(top());
  }
  void through() {
    move_to(19.6 * mm);
    move_to(20.05 * mm);
    channel.leave(bottom());
  }
  void cut(std::size_t i, Real x) {
    const Real depth = channel.samples()[i].depth;
    channel.cut_to(i, Vec3(x, 0, -depth));
  }
  std::vector<PathSample::Kind> kinds() const {
    std::vector<PathSample::Kind> out;
    for (std::size_t i = 0; i < channel.passed(); ++i) out.push_back(channel.samples()[i].kind);
    return out;
  }
};
using Kind = PathSample::Kind;

TEST_F(CutOutOfChannel, WhatIsStillInsideHasMoved) {
  through();
  const std::size_t count = channel.passed();
  for (std::size_t i = 0; i < count; ++i) cut(i, 1.5 * mm);
  channel.drop_cut_out();
  ASSERT_EQ(channel.passed(), count);
  for (std::size_t i = 0; i < count; ++i)
    EXPECT_NEAR(slab.position(channel.samples()[i].at, Configuration::current).x(), 1.5 * mm,
                1e-15);
  EXPECT_EQ(kinds().front(), Kind::entry);
  EXPECT_EQ(kinds().back(), Kind::exit);
}

TEST_F(CutOutOfChannel, InItsMiddleTheBiteBecomesTwo) {
  through();
  for (std::size_t i = 5; i < 15; ++i) cut(i, 2.5 * mm);
  channel.drop_cut_out();
  std::vector<Kind> expected(11, Kind::inner);
  expected[0] = expected[5] = Kind::entry;
  expected[4] = expected[10] = Kind::exit;
  EXPECT_EQ(kinds(), expected);
  // From the top to 4 mm and from 15 mm to the bottom.
  EXPECT_NEAR(channel.inserted_length(), 9 * mm, 1e-12);
}

TEST_F(CutOutOfChannel, WithoutAnythingButMouthsItIsGone) {
  through();
  for (std::size_t i = 1; i + 1 < channel.passed(); ++i) cut(i, 2.5 * mm);
  channel.drop_cut_out();
  EXPECT_EQ(channel.passed(), 0u);
  EXPECT_EQ(channel.inserted_length(), 0);
  EXPECT_FALSE(channel.tip_inside());
}

TEST_F(CutOutOfChannel, ATipWhoseBiteIsStillThereGoesOn) {
  move_to(8.4 * mm);
  cut(3, 2.5 * mm);
  channel.drop_cut_out();
  EXPECT_TRUE(channel.tip_inside());
  EXPECT_TRUE(channel.tip_at_end());
  EXPECT_NEAR(channel.inserted_length(), (2 + 4.4) * mm, 1e-12);
  move_to(10.4 * mm);
  EXPECT_NEAR(channel.inserted_length(), (2 + 6.4) * mm, 1e-12);
}

TEST_F(CutOutOfChannel, ATipWhoseBiteIsGoneIsOutside) {
  move_to(8.4 * mm);
  move_to(5.4 * mm);  // leaves samples that are remembered
  for (std::size_t i = 2; i < channel.passed(); ++i) cut(i, 2.5 * mm);
  channel.drop_cut_out();
  EXPECT_EQ(kinds(), (std::vector<Kind>{Kind::entry, Kind::exit}));
  EXPECT_FALSE(channel.tip_inside());
  EXPECT_EQ(channel.samples().size(), 2u);
}

}  // namespace
}  // namespace sutura::testing
