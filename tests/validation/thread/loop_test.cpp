// A 300 mm thread pulled into a loop of 1 mm radius: adaptive against uniform sampling, at rest and
// in motion.
#include "loop.h"

#include <gtest/gtest.h>

#include "reference_table.h"
#include "unit/thread/divided_step.h"

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
  EXPECT_NEAR(pose(middle + far, l).position.x() - pose(middle - far, l).position.x(),
              length - 4 * l, 1e-15);
  EXPECT_NEAR(pose(length, l).position.y(), -2 * l, 1e-15);
}

TEST(Loop, UniformBeamsConvergeToIt) {
  Errors before;
  for (const Index beams : {300, 600, 1200}) {
    Rod rod = laid_out(beams, tight);
    ASSERT_TRUE(pull(rod, tight)) << beams;
    const Errors now = errors(rod, tight);
    std::printf("uniform, %td beams: shortening %.1e, height %.1e, curvature %.1e\n",
                static_cast<std::ptrdiff_t>(beams), now.shortening, now.height, now.curvature);
    // Fourth order; 0.5 mm beams of 1 rad at the apex are not yet where it sets in. The cubic has
    // curvature to second.
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
    // Asked: the accuracy of uniform sampling with at least four times fewer beams. Beams in pairs:
    // a node at the apex.
    const Index many = 4 * adaptive.beams() + 4 * adaptive.beams() % 2;
    Rod uniform = laid_out(many, tight);
    ASSERT_TRUE(pull(uniform, tight)) << many;
    const Errors u = errors(uniform, tight);
    std::printf(
        "%.1f rad, %td beams: shortening %.1e, height %.1e, curvature %.1e; %td uniform: %.1e, "
        "%.1e, %.1e\n",
        angle, static_cast<std::ptrdiff_t>(adaptive.beams()), a.shortening, a.height, a.curvature,
        static_cast<std::ptrdiff_t>(many), u.shortening, u.height, u.curvature);
    EXPECT_TRUE(a.below(u)) << angle;
  }
}

/// Shortest and longest beam within `reach` of the middle, or (outside) beyond it.
struct Lengths {
  Real shortest = length, longest = 0;
  Lengths(const Rod& rod, Real reach, bool outside) {
    const auto& a = rod.abscissa();
    for (Index e = 0; e < rod.beams(); ++e) {
      const bool beyond = std::min(std::abs(a[e] - middle), std::abs(a[e + 1] - middle)) > reach;
      if (beyond != outside) continue;
      shortest = std::min(shortest, a[e + 1] - a[e]);
      longest = std::max(longest, a[e + 1] - a[e]);
    }
  }
};

TEST(Loop, SamplingFollowsAThreadPulledTightAndLetGo) {
  // From a 10 mm loop to 1 mm in 2 s, half a second of rest; wide again in 2 s, rest.
  constexpr Real dt = 5e-3, wide = 10 * tight;
  constexpr int pulling = 400, resting = 100, half = pulling + resting;
  Rod rod = laid_out(64, wide);
  RodStep step(rod);
  SamplingWork work;
  Index most = 0;
  int events = 0;
  Real fastest = 0;
  for (int i = 0; i < 2 * half; ++i) {
    const Real part = std::min(1., static_cast<Real>(i % half) / pulling);
    hold_ends(rod, wide + (tight - wide) * (i < half ? part : 1 - part));
    // Shaken out of its plane all the time: the motion is one in space.
    const Vec3 shaking(0, 0, 0.5 * std::sin(7. * i));
    ASSERT_TRUE(divided_step(rod, step, dt, shaking)) << i;
    ASSERT_TRUE(rod.finite());
    if (resample(rod, rules(0.2), work)) {
      step.fit(rod);
      ++events;
      EXPECT_LT(i % half, pulling + resting / 2) << "still sampling at rest";
    }
    most = std::max(most, rod.beams());
    for (Index k = 0; k < rod.nodes(); ++k)
      fastest = std::max(fastest, rod.velocity().segment<3>(6 * k).norm());
    if (i == half - 1) {
      // Between ends at this distance the tension goes with the square of the shortening, whose
      // error at rest with 0.2 rad is 2e-5 (above); the shaking moves a loop of this stiffness by
      // less.
      EXPECT_NEAR(rod.springs()[1].applied.force.x() / tension(tight), 1, 1e-4);
      EXPECT_LT(errors(rod, tight).height, 1e-4);
      EXPECT_LT(errors(rod, tight).curvature, 0.01);
      // Of 0.2 rad at most where the curvature is 1000/m.
      EXPECT_LE(Lengths(rod, 2 * tight, false).shortest, 0.2e-3);
      EXPECT_GT(Lengths(rod, 12 * tight, true).shortest, 4e-3);  // merged, outside it
      EXPECT_LT(rod.beams(), 100);
    }
  }
  std::printf("pulled tight and let go: %d events, %td beams at most, %.3f m/s\n", events,
              static_cast<std::ptrdiff_t>(most), fastest);
  EXPECT_GT(events, 20);
  EXPECT_LT(most, 120);      // no runaway
  EXPECT_LT(fastest, 0.05);  // m/s; the ends and the top move at 0.02
  // Wide again, curvature at most 100/m: beams have merged as long as two together stayed below 0.1
  // rad.
  EXPECT_GT(Lengths(rod, 2 * tight, false).shortest, 0.5e-3);
}

}  // namespace
}  // namespace sutura::thread::loop
