// A 300 mm thread pulled into a loop of 1 mm radius: adaptive against uniform sampling, at rest and in motion.
#include "loop.h"

#include <gtest/gtest.h>

#include "reference_table.h"

namespace sutura::thread::loop {
namespace {

TEST(Loop, ClosedFormIsTheTable) {
  const ReferenceTable table("a10c_planar_loop.csv");
  ASSERT_GT(table.rows.size(), 4u);
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const Real l = std::sqrt(table.number(i, "B N m2") / table.number(i, "T N"));
    // The table has ten digits.
    EXPECT_NEAR(table.number(i, "end shortening m"), 4 * l, 1e-9 * l);
    EXPECT_NEAR(table.number(i, "max curvature 1/m"), 2 / l, 1e-9 / l);
    EXPECT_NEAR(table.number(i, "loop height m"), 2 * l, 1e-9 * l);
  }
  const Real l = tight, far = middle;
  EXPECT_NEAR(pose(middle + far, l).position.x() - pose(middle - far, l).position.x(), length - 4 * l, 1e-15);
  EXPECT_NEAR(pose(length, l).position.y(), -2 * l, 1e-15);
}

TEST(Loop, UniformBeamsConvergeToIt) {
  Errors before;
  for (const Index beams : {300, 600, 1200}) {
    Rod rod = laid_out(beams, tight);
    ASSERT_TRUE(pull(rod, tight)) << beams;
    const Errors now = errors(rod, tight);
    std::printf("uniform, %td beams: shortening %.1e, height %.1e, curvature %.1e\n", static_cast<std::ptrdiff_t>(beams),
                now.shortening, now.height, now.curvature);
    // Fourth order; 0.5 mm beams of 1 rad at the apex are not yet where it sets in. The cubic has curvature to second.
    if (beams > 300) {
      EXPECT_GT(std::log2(before.shortening / now.shortening), 3);
      EXPECT_GT(std::log2(before.height / now.height), 3);
      EXPECT_GT(std::log2(before.curvature / now.curvature), 1.5);
    }
    before = now;
  }
}

TEST(Loop, AdaptiveNeedsFourTimesFewerBeams) {
  for (const Real angle : {0.8, 0.4, 0.2, 0.1}) {
    Rod adaptive;
    ASSERT_TRUE(pull_tight(adaptive, angle)) << angle;
    const Errors a = errors(adaptive, tight);
    // Asked: the accuracy of uniform sampling with at least four times fewer beams. Beams in pairs: a node at the apex.
    const Index many = 4 * adaptive.beams() + 4 * adaptive.beams() % 2;
    Rod uniform = laid_out(many, tight);
    ASSERT_TRUE(pull(uniform, tight)) << many;
    const Errors u = errors(uniform, tight);
    std::printf("%.1f rad, %td beams: shortening %.1e, height %.1e, curvature %.1e; %td uniform: %.1e, %.1e, %.1e\n", angle,
                static_cast<std::ptrdiff_t>(adaptive.beams()), a.shortening, a.height, a.curvature,
                static_cast<std::ptrdiff_t>(many), u.shortening, u.height, u.curvature);
    EXPECT_TRUE(a.below(u)) << angle;
  }
}

}  // namespace
}  // namespace sutura::thread::loop
