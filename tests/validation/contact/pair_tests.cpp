// What holds for every pair: momentum, and that a state goes on to the bit.
#include <gtest/gtest.h>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

/// A thread flies across another; both are free.
std::string collision() {
  return "<plugin name='contact'/>"
         "<SutureThread name='a' needle_length='0' thread_diameter='0.2 mm' thread_length='20 mm' "
         "thread_beams='20' tip='0 -6 1 mm' tip_direction='0 -1 0' velocity='0.1 0 -0.4'/>"
         "<SutureThread name='b' needle_length='0' thread_diameter='0.2 mm' thread_length='20 mm' "
         "thread_beams='20' tip='-10 0 0 mm' tip_direction='-1 0 0'/>"
         "<Contact first='a' second='b' friction='0.3'/>";
}

TEST(Pair, WhatOneLosesTheOtherGains) {
  TextRun run(collision(), "dt='1 ms' gravity='0 0 0' tolerance='1e-5'");
  ASSERT_TRUE(run) << run.said();
  const auto momentum = [&] {
    return Vec3(run.vector("/a", "momentum") + run.vector("/b", "momentum"));
  };
  const Vec3 before = momentum();
  Real passed_on = 0;
  for (int i = 0; i < 20; ++i) {
    const StepReport& report = run.simulation().step();
    EXPECT_TRUE(report.solved) << i << " " << report.worst_imbalance().relative << " "
                               << (momentum() - before).norm() / before.norm();
    // A step may leave 1e-5 of the forces at work unbalanced.
    EXPECT_LT((momentum() - before).norm(), 1e-4 * before.norm()) << i;
    passed_on = std::max(passed_on, run.vector("/b", "momentum").norm());
  }
  EXPECT_GT(passed_on, 0.1 * before.norm());
}

TEST(Pair, AStateGoesOnToTheBit) {
  const std::string settings = "dt='1 ms' gravity='0 0 0'";
  TextRun whole(collision(), settings), other(collision(), settings);
  ASSERT_TRUE(whole) << whole.said();
  while (whole.number("/contact", "touches") < 1 && whole.simulation().time() < 0.02)
    whole.simulation().step();
  ASSERT_GT(whole.number("/contact", "touches"), 0);
  const std::vector<std::byte> state = whole.simulation().save();
  ASSERT_EQ(other.simulation().restore(state), "");
  for (int i = 0; i < 10; ++i) {
    whole.simulation().step();
    other.simulation().step();
    ASSERT_EQ(whole.vector("/a", "tip_position"), other.vector("/a", "tip_position")) << i;
    ASSERT_EQ(whole.vector("/contact", "force"), other.vector("/contact", "force")) << i;
  }
}

}  // namespace
}  // namespace sutura::testing
