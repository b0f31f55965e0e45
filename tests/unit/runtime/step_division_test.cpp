#include "runtime/step_division.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

using namespace sutura;

namespace {

struct Walk {
  int failures = 0, refused = 0, parts = 0;
};

/// Goes through a step whose tries fail where a bit of `failures` is set, and checks that what is
/// accepted fills the step without gap or overlap.
Walk walk(Index most, unsigned failures) {
  Walk w;
  StepDivision division(most);
  Real reached = 0;  // in units of the step; sums of powers of two, so exact
  unsigned bits = failures;
  while (!division.done()) {
    EXPECT_EQ(division.begin(), reached);
    EXPECT_LE(division.parts(), most);
    const Index before = division.parts();
    const bool fails = bits & 1;
    bits >>= 1;
    if (fails) {
      ++w.failures;
      if (division.halve()) {
        EXPECT_EQ(division.parts(), 2 * before);
        EXPECT_EQ(division.begin(), reached);  // the same place, half as far
        continue;
      }
      EXPECT_EQ(before, most);  // refused only where it cannot be any shorter
      EXPECT_EQ(division.parts(), before);
      ++w.refused;
    }
    reached += 1 / static_cast<Real>(division.parts());
    division.next();
    ++w.parts;
    // At most twice as long as the part before, and only where that begins on its own grid.
    EXPECT_GE(2 * division.parts(), before);
    if (w.parts > 1000) {
      ADD_FAILURE() << "does not end";
      break;
    }
  }
  EXPECT_EQ(reached, 1);
  return w;
}

TEST(StepDivision, EveryPatternOfFailuresFillsTheStep) {
  for (const Index most : {1, 2, 4, 8})
    for (unsigned failures = 0; failures < (1u << 12); ++failures) walk(most, failures);
}

TEST(StepDivision, OneFailureCostsTwoParts) {
  const Walk w = walk(64, 1);
  EXPECT_EQ(w.parts, 2);
  EXPECT_EQ(w.refused, 0);
}

TEST(StepDivision, GrowsAgainAfterSuccess) {
  // Three failures at the start: an eighth, then as long as fits: 1/8 1/8 1/4 1/2.
  StepDivision division(8);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(division.halve());
  EXPECT_FALSE(division.halve());
  std::vector<Index> parts;
  for (; !division.done(); division.next()) parts.push_back(division.parts());
  EXPECT_EQ(parts, (std::vector<Index>{8, 8, 4, 2}));
}

// Where no length is solved, the one that lacks least is tried once more, and then taken; the parts
// after it are as long as fits.
TEST(StepDivision, GoesBackToWhatLackedLeast) {
  StepDivision division(4);
  for (const Real lacks : {7., 2., 30.}) EXPECT_TRUE(division.try_again(lacks));
  EXPECT_EQ(division.parts(), 2);
  EXPECT_EQ(division.begin(), 0);
  EXPECT_FALSE(division.try_again(2));
  division.next();
  EXPECT_EQ(division.parts(), 2);
  EXPECT_EQ(division.begin(), 0.5);
  // A new part: what lacked least before counts no more. Of equals the shortest, with more passes.
  EXPECT_TRUE(division.try_again(9));
  EXPECT_FALSE(division.is_last_try());
  EXPECT_TRUE(division.try_again(9));
  EXPECT_TRUE(division.is_last_try());
  EXPECT_EQ(division.parts(), 4);
  EXPECT_EQ(division.begin(), 0.5);
  EXPECT_FALSE(division.try_again(9));
  division.next();
  EXPECT_EQ(division.begin(), 0.75);
}

// The same length is not tried again where more passes are of no use: what is balanced but too
// long, what is not finite, and a step that is not to be divided.
TEST(StepDivision, TriesTheSameAgainOnlyForMorePasses) {
  for (const Real lacks : {Real(0), std::numeric_limits<Real>::infinity()}) {
    StepDivision division(2);
    EXPECT_TRUE(division.try_again(lacks));
    EXPECT_FALSE(division.try_again(lacks));
  }
  StepDivision whole(1);
  EXPECT_FALSE(whole.try_again(3));
}

TEST(StepDivision, NeverDividesIfToldSo) {
  StepDivision division(1);
  EXPECT_FALSE(division.halve());
  EXPECT_EQ(division.parts(), 1);
  division.next();
  EXPECT_TRUE(division.done());
}

}  // namespace
