// What is where it cannot be when the scene begins is refused; what is only near is not.
#include <gtest/gtest.h>

#include <cmath>

#include "contact_scenes.h"
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

const std::string skin =
    "<plugin name='contact'/>" +
    block("skin", "-10 -10 -8 10 10 0", "2 2 2", "<Attach box='-10 -10 -8 10 10 -8 mm'/>");
const std::string on_ball = "<Contact first='/skin/tissue' tool='ball'/>";

std::string ball(const std::string& where) {
  return "<Tool name='ball' shape='sphere' radius='2 mm' centre='" + where + " mm'/>";
}

void expect_overlap(const std::string& content, const std::string& by) {
  TextRun run(content);
  EXPECT_FALSE(run);
  EXPECT_NE(run.said().find("overlap by " + by), std::string::npos) << run.said();
}

TEST(Start, AThreadInsideOfATissueIsRefused) {
  expect_overlap(skin + thread("a", Vec3(0, 0.3e-3, -3e-3), Vec3::UnitX(), 8e-3, 8) +
                     "<Contact first='a' second='/skin/tissue'/>",
                 "3.1");
}

TEST(Start, AToolInsideOfATissueIsRefused) {
  expect_overlap(skin + ball("3 3 -4") + on_ball, "6.0");
}

// The surface has no node within 3 mm of it.
TEST(Start, AToolBetweenTheNodesOfATissueIsRefused) {
  expect_overlap(skin + ball("3 4 1") + on_ball, "1.0");
}

// A hundredth of a millimetre is rounding for a thread of 0.2 mm, and as much as one of 11-0 is
// thick: it could not move.
TEST(Start, AThinThreadMayOverlapByLess) {
  const auto laid = [](const std::string& radius, const std::string& height) {
    return "<plugin name='contact'/><SutureThread name='a' needle_length='0' thread_length='10 mm' "
           "thread_diameter='" +
           radius + "' tip='0 0 " + height +
           "' tip_direction='-1 0 0'/><Tool name='table' shape='plane'/><Contact tool='table'/>";
  };
  EXPECT_TRUE(TextRun(laid("0.2 mm", "0.0920 mm")));
  expect_overlap(laid("0.01 mm", "-0.001 mm"), "0.006");
}

TEST(Start, DistancesAreThoseOfTheSurfaces) {
  TextRun tool(skin + ball("3 4 5") + on_ball);
  ASSERT_TRUE(tool) << tool.said();
  EXPECT_NEAR(tool.number("/contact", "distance"), 3e-3, 1e-9);

  // A thread on end, its lower end 2 mm above the skin.
  TextRun curve(
      skin + thread("a", Vec3(1e-3, 2e-3, 6e-3), Vec3::UnitZ(), 8e-3, 8, "plane_normal='1 0 0'") +
      "<Contact first='a' second='/skin/tissue'/>");
  ASSERT_TRUE(curve) << curve.said();
  EXPECT_NEAR(curve.number("/contact", "distance"), 2e-3 - 0.1e-3, 1e-9);

  // A thread that leans towards the skin, near it all along: its first beam is not the nearest.
  const Vec3 lean = Vec3(1, 0, -0.01).normalized();
  TextRun leaning(skin + thread("a", Vec3(1e-3, 2e-3, 0.15e-3), lean, 8e-3, 8) +
                  "<Contact first='a' second='/skin/tissue'/>");
  ASSERT_TRUE(leaning) << leaning.said();
  const Real lower_end = 0.15e-3 - 4e-3 * 0.01;
  EXPECT_NEAR(leaning.number("/contact", "distance"), lower_end - 0.1e-3, 0.01e-6);

  // Bodies further apart than they are long, the second beside the first.
  TextRun blocks(skin + block("other", "40 -3 -8 44 3 0", "2 2 2") +
                 "<Contact first='/skin/tissue' second='/other/tissue'/>");
  ASSERT_TRUE(blocks) << blocks.said();
  EXPECT_NEAR(blocks.number("/contact", "distance"), 30e-3, 1e-12);
}

// Of a tissue with itself: the lips of a slit face each other, the sides of a block do not.
TEST(Start, ATissueIsAsFarFromItselfAsItsLips) {
  const auto slit = [](const std::string& holes) {
    return "<plugin name='contact'/><BlockMesh box='-6 -4 -6 6 4 0 mm' cells='12 4 6' " + holes +
           "/><Tissue young='20 kPa' poisson='0.3'/><Attach box='-6 -4 -6 6 4 -6 mm'/>"
           "<Contact/>";
  };
  TextRun lips(slit("holes='-1 -4 -4 1 4 0 mm'"));
  ASSERT_TRUE(lips) << lips.said();
  EXPECT_NEAR(lips.number("/contact", "distance"), 2e-3, 1e-9);
  TextRun block(slit(""));
  ASSERT_TRUE(block) << block.said();
  EXPECT_TRUE(std::isinf(block.number("/contact", "distance")));
}

}  // namespace
}  // namespace sutura::testing
