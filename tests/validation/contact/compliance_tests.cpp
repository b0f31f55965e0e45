// Touches that give way: they overlap by their compliance times their force, however much that is.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

/// Runs it, and expects every step to be solved and without a fault.
void run_without_fault(TextRun& run, Real seconds) {
  while (run.simulation().time() < seconds - 1e-9)
    EXPECT_FALSE(run.simulation().step().missed()) << run.simulation().time();
}

// Two taut threads of 0.3 mm that cross, pressed into each other by a tenth and by a fifth of
// what they are thick. That is no overlap which a step has left: it was taken for one beyond a
// twentieth, and the force stayed what it was there. Bounds: a thousandth of what the gaps of a
// step may be off by (1 um), as touches at rest are solved far beyond it; 1 % of force is the
// tolerance of balance.
TEST(Compliance, OfTwoThreadsThatCross) {
  for (const char* compliance : {"7 mm/N", "20 mm/N"}) {
    for (const char* dt : {"2 ms", "10 ms", "50 ms"}) {
      SCOPED_TRACE(std::string(compliance) + ", " + dt);
      TextRun run(std::string("<plugin name='contact'/>"
                              "<SutureThread name='under' needle_length='0' thread_length='40 mm' "
                              "thread_diameter='0.3 mm' thread_young='2 GPa' tip='-20 0 0 mm' "
                              "tip_direction='-1 0 0' thread_beams='40' clamp='both' "
                              "damping_stiffness='1 ms' damping_mass='20 1/s'/>"
                              "<SutureThread name='over' needle_length='0' thread_length='40 mm' "
                              "thread_diameter='0.3 mm' thread_young='2 GPa' tip='0 -20 0.32 mm' "
                              "tip_direction='0 -1 0' thread_beams='40' damping_stiffness='1 ms' "
                              "damping_mass='20 1/s'/>"
                              "<Track name='way' times='0 0.3 s' positions='0 0 0  0 0 -1.0 mm' "
                              "easing='smooth'/>"
                              "<Grasper name='left' body='over' at='0' track='way'/>"
                              "<Grasper name='right' body='over' at='40 mm' track='way'/>"
                              "<Contact name='contact' first='over' second='under' friction='0.2' "
                              "compliance='") +
                      compliance + "'/>",
                  std::string("gravity='0 0 0' dt='") + dt + "'");
      ASSERT_TRUE(run) << run.said();
      run_without_fault(run, 0.5);
      const Real force = run.number("/contact", "largest_force");
      const Real stiff = std::string(compliance) == "7 mm/N" ? 7e-3 : 20e-3;  // m/N
      EXPECT_GT(force, 2e-3);
      EXPECT_NEAR(run.number("/contact", "distance"), -stiff * force, 1e-9);
      const Real hands = run.vector("/left", "force").z() + run.vector("/right", "force").z();
      EXPECT_NEAR(hands, -run.vector("/contact", "force").z(), 1e-2 * force);
    }
  }
}

// Two stiff rods that cross at 25 degrees, squeezed by 20 um, one of them drawn along itself. They
// touch at one place, and give way there by 1 mm/N and as beams that are clamped, by L^3 / (192 E
// I) each. Where every place that has been touched gave way on its own, they pressed with twice to
// three times as much as soon as one slid, the more the shorter the step.
TEST(Compliance, OfRodsThatSlideAcrossEachOther) {
  const Real length = 20e-3, young = 200e9, diameter = 0.4e-3;
  const Real beam =
      std::pow(length, 3) / (192 * young * std::numbers::pi * std::pow(diameter, 4) / 64);
  const Real right = 20e-6 / (1e-3 + 2 * beam);
  const std::string rod =
      " needle_length='0' thread_length='20 mm' thread_diameter='0.4 mm' thread_beams='20' "
      "thread_young='200 GPa' plane_normal='0 0 1' ";
  for (const char* dt : {"2 ms", "10 ms"}) {
    SCOPED_TRACE(dt);
    TextRun run("<plugin name='contact'/><SutureThread name='a'" + rod +
                    "tip='10 0 0.41 mm' tip_direction='1 0 0'/><SutureThread name='b'" + rod +
                    "tip='9.06307787 4.22618262 0 mm' tip_direction='0.906307787 0.422618262 0' "
                    "clamp='both'/>"
                    "<Track name='way' times='0 0.05 0.1 0.3 s' "
                    "positions='0 0 0  0 0 -0.03  0 0 -0.03  1 0 -0.03 mm'/>"
                    "<Grasper name='left' body='a' at='0' track='way'/>"
                    "<Grasper name='right' body='a' at='20 mm' track='way'/>"
                    "<Contact name='contact' first='a' second='b' friction='0.3' "
                    "compliance='1 mm/N'/>",
                std::string("gravity='0 0 0' dt='") + dt + "'");
    ASSERT_TRUE(run) << run.said();
    run_without_fault(run, 0.1);
    EXPECT_NEAR(run.number("/contact", "normal_force"), right, 0.01 * right);
    while (run.simulation().time() < 0.3 - 1e-9) {
      EXPECT_FALSE(run.simulation().step().missed());
      // The place wanders off the middle of the beams by 1 mm; a node may touch beside it.
      EXPECT_NEAR(run.number("/contact", "normal_force"), right, 0.05 * right);
    }
  }
}

}  // namespace
}  // namespace sutura::testing
