#include "runtime/progress.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

using namespace sutura;

namespace {

/// The pass after which a step that lacks so much after each of its passes is given up, or 0.
int given_up_after(const std::vector<Real>& lacks) {
  Progress progress;
  for (std::size_t i = 0; i < lacks.size(); ++i) {
    progress.add(lacks[i]);
    if (progress.stands()) return static_cast<int>(i) + 1;
  }
  return 0;
}

TEST(Progress, PassesThatContractGoOn) {
  std::vector<Real> slow, quick;
  for (int i = 0; i < 20; ++i) {
    slow.push_back(400 * std::pow(0.9, i));  // below 0.8 of the least so far at every third
    quick.push_back(400 * std::pow(0.1, i));
  }
  EXPECT_EQ(given_up_after(slow), 0);
  EXPECT_EQ(given_up_after(quick), 0);
}

TEST(Progress, AGuessThatStandsIsGivenUp) {
  EXPECT_EQ(given_up_after(std::vector<Real>(20, 492)), 7);
  const Real infinite = std::numeric_limits<Real>::infinity();
  EXPECT_EQ(given_up_after(std::vector<Real>(20, infinite)), 7);
}

TEST(Progress, OneThatSwingsIsGivenUpFourPassesAfterItsBest) {
  EXPECT_EQ(given_up_after({90, 50, 70, 60, 20, 70, 60, 50, 40, 30, 9}), 9);
}

TEST(Progress, NearTheToleranceItGoesOn) {
  EXPECT_EQ(given_up_after({60, 20, 4.9, 8, 9, 7, 12, 30, 25, 16, 8, 5}), 0);
}

TEST(Progress, AnEventBeginsItAnew) {
  Progress progress;
  for (int i = 0; i < 6; ++i) progress.add(50);
  progress.begin();
  for (int i = 0; i < 6; ++i) {
    progress.add(50);
    EXPECT_FALSE(progress.stands());
  }
}

}  // namespace
