// Tools and needles that turn far within a step: what is between the arc on which they go and its
// chord is in their way, too.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "contact_scenes.h"
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

constexpr Real thick = 0.1e-3;  // m, of the blades
constexpr Real r = 0.1e-3;      // m, of the threads (contact_scenes.h)

Vec3 at_angle(Real radius, Real angle) {
  return {radius * std::cos(angle), radius * std::sin(angle), 0};
}

/// Turns about z by so much within a time, at a constant pace.
std::string turning(Real angle, Real time, const std::string& more = "") {
  std::ostringstream s;
  s << std::setprecision(17) << "<Track name='go' times='0 " << time << "' rotations='0 0 0 0 0 "
    << angle << "' " << more << "/>";
  return s.str();
}

/// A blade along x, as a mesh: 30 mm high.
std::string mesh_blade(Real from, Real to) {
  const std::string file = SUTURA_BINARY_DIR "/blade_" + std::to_string(to) + ".obj";
  std::ofstream out(file);
  for (const Real x : {from, to})
    for (const Real y : {-thick / 2, thick / 2})
      for (const Real z : {-0.015, 0.015}) out << "v " << text_of(Vec3(x, y, z)) << '\n';
  for (const char* face : {"1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"})
    out << "f " << face << '\n';
  return "<Tool name='blade' shape='mesh' file='" + file + "' motion='go'/>";
}

std::string box_blade(Real from, Real to) {
  return "<Tool name='blade' shape='box' size='" + text_of({to - from, thick, 0.03}) +
         "' centre='" + text_of({(from + to) / 2, 0, 0}) + "' motion='go'/>";
}

std::string capsule_blade(Real from, Real to) {
  return "<Tool name='blade' shape='capsule' axis='1 0 0' radius='" + std::to_string(thick / 2) +
         "' length='" + std::to_string(to - from) + "' centre='" +
         text_of({(from + to) / 2, 0, 0}) + "' motion='go'/>";
}

/// A thread of 12 mm along z.
std::string upright(const Vec3& middle, const std::string& more = "") {
  return thread("a", middle, Vec3::UnitZ(), 0.012, 12, "plane_normal='1 0 0' " + more);
}

std::string held(const Vec3& middle) {
  return upright(middle, "clamp='both'");
}

TextRun scene(const std::string& content, Real step) {
  TextRun run("<plugin name='contact'/>" + content,
              "dt='" + std::to_string(step) + "' gravity='0 0 0'");
  EXPECT_TRUE(run) << run.said();
  return run;
}

/// Does any step say that it is not accurate, or at fault?
bool says_so(TextRun& run, Real seconds) {
  bool said = false;
  while (run.simulation().time() < seconds - 1e-9) {
    const StepReport& report = run.simulation().step();
    said = said || report.missed();
  }
  return said;
}

// 10 rad/s for 50 ms, a thread parallel to the axis at 0.35 rad, further out than chords reach
// there. Without friction it then goes as a bead beside a rod that turns. Seen from the rod it
// begins with the speed w c along it, c before it, and is driven outwards: x'' = w^2 x, so x = X
// cosh(w t) + c sinh(w t).
TEST(Swept, AFreeThreadIsPushedAheadAtAnyStep) {
  constexpr Real w = 10, time = 0.05, met = 0.35, R = 0.0186;
  for (const auto& blade : {mesh_blade, box_blade})
    for (const Real step : {0.001, 0.0025, 0.005, 0.01, 0.025, 0.05}) {
      TextRun run = scene(upright(at_angle(R, met)) + turning(w * time, time) +
                              blade(0.013, 0.019) + "<Contact tool='blade' friction='0'/>",
                          step);
      EXPECT_FALSE(says_so(run, time)) << step;
      const Real touching = thick / 2 + r, t = time - met / w - touching / R / w;
      for (const char* end : {"tip_position", "end_position"}) {
        const Vec3 p = run.vector("/a", end);
        const Vec3 seen = Eigen::AngleAxis<Real>(-w * time, Vec3::UnitZ()) * p;
        // A touch leaves the tolerance of gaps, 1 um, and as much for rounding of the curve.
        EXPECT_GT(seen.y(), touching - 2e-6) << step << ' ' << end;
        // Implicit Euler pushes along the normal of the end of a part, and so across that of its
        // start: by up to R (w h)^2 along the blade as it meets the thread, and at a speed of up to
        // 2 R w (w h) from then on. 50 ms are divided, into parts of 12.5 ms or less.
        const Real h = std::min(step, 0.0125), turn = w * t;
        const Real expected = R * std::cosh(turn) + touching * std::sinh(turn);
        EXPECT_NEAR(seen.x(), expected, R * w * h * (w * h + 2 * turn)) << step << ' ' << end;
      }
    }
}

// It cannot get out of the way. At any angle in a step, either way round, and about a point beside.
TEST(Swept, AHeldThreadIsNotPassedInSilence) {
  for (const auto& blade : {mesh_blade, box_blade, capsule_blade})
    for (const Real angle : {0.5, 2.1, -2.5, 3.})
      for (const Real beside : {0., 3e-3}) {
        const Vec3 centre(beside, -beside, 0);
        // Where half of the turn takes a point of the blade 0.3 mm from its end. Nearer to the end
        // the thread gets out of the way: it slips off.
        const Eigen::AngleAxis<Real> half(angle / 2, Vec3::UnitZ());
        TextRun run = scene(held(centre + half * (Vec3(0.0187, 0, 0) - centre)) +
                                turning(angle, 0.01, "centre='" + text_of(centre) + "'") +
                                blade(0.013, 0.019) + "<Contact tool='blade'/>",
                            0.01);
        EXPECT_TRUE(says_so(run, 0.01) || run.number("/contact", "touches") > 0)
            << angle << ' ' << beside;
      }
}

// It turns about one point and goes along by another, so that its ball is at the end where it was,
// and half way 2.15 mm from there: out and back within one step.
TEST(Swept, ABallThatSwingsOutAndBackIsSeen) {
  const Vec3 ball(0.02, 0, 0), back = ball - at_angle(0.02, 1);
  const auto swung = [&](const Vec3& place, Index& parts) {
    TextRun run =
        scene(held(place) + turning(1, 0.01, "positions='0 0 0 " + text_of(back) + "'") +
                  "<Tool name='ball' shape='sphere' radius='0.001' centre='0.02 0 0' motion='go'/>"
                  "<Contact tool='ball'/>",
              0.01);
    const StepReport& report = run.simulation().step();
    parts = report.parts;
    return report.passes > report.parts || report.missed();
  };
  Index parts = 0;
  EXPECT_TRUE(swung({0.0217, 0.0009, 0}, parts));  // 0.5 mm from its centre half way
  EXPECT_GT(parts, 1);
  EXPECT_FALSE(swung({0.015, 0.0009, 0}, parts));
  EXPECT_EQ(parts, 1);
}

// A block of tissue that is held below, in the way of a blade that turns by 1.5 to 3 rad in a step.
TEST(Swept, TissueIsNotPassedInSilence) {
  using Blade = std::string (*)(Real, Real);
  for (const auto& [blade, angle] :
       {std::pair<Blade, Real>{mesh_blade, 1.5}, {box_blade, -1.5}, {capsule_blade, 3.}}) {
    const Vec3 middle = 1e3 * at_angle(0.016, angle / 2), half(1, 1, 5);
    const Vec3 low = middle - half, high = middle + half;
    const Vec3 bottom(high.x(), high.y(), low.z());
    TextRun run = scene(block("k", text_of(low) + ' ' + text_of(high), "2 2 4",
                              "<Attach box='" + text_of(low) + ' ' + text_of(bottom) + " mm'/>") +
                            turning(angle, 0.05) + blade(0.013, 0.019) +
                            "<Contact first='/k/tissue' tool='blade'/>",
                        0.05);
    EXPECT_TRUE(says_so(run, 0.05) || run.number("/contact", "touches") > 0) << angle;
  }
}

// A straight needle, held at its point by a hand that turns by 1.5 rad in 10 ms: a bar at 1.2 rad
// stops it, at any step.
TEST(Swept, ACarriedNeedleStopsAtABar) {
  for (const Real angle : {1.5, -1.5})
    for (const Real step : {0.01, 0.005, 0.00125}) {
      const Real at = angle > 0 ? 1.2 : -1.2;
      TextRun run = scene(
          "<SutureThread name='s' needle_length='20 mm' needle_angle='0' needle_beams='8' "
          "needle_diameter='0.3 mm' thread_length='0.2 mm' thread_beams='1' thread_diameter='0.1 "
          "mm' tip='0 0 0' tip_direction='-1 0 0' plane_normal='0 0 1'/>" +
              turning(angle, 0.01) + "<Grasper at='0.5 mm' track='go'/>" +
              "<Tool name='bar' shape='capsule' radius='0.2 mm' length='20 mm' centre='" +
              text_of(at_angle(0.018, at)) + "'/><Contact first='s' tool='bar'/>",
          step);
      EXPECT_FALSE(says_so(run, 0.01)) << step;
      const Vec3 end = run.vector("/s", "end_position");
      EXPECT_LT(std::abs(std::atan2(end.y(), end.x())), std::abs(at)) << step;
      EXPECT_EQ(run.number("/contact", "touches"), 1) << step;
      // It lies on the bar, to the tolerance of gaps, and as much for what it is nearer beside the
      // touch.
      EXPECT_NEAR(run.number("/contact", "distance"), 0, 2e-6) << step;
    }
}

// A straight needle that turns by 1.5 rad in a step, and a thread that is held across its way.
TEST(Swept, ACarriedNeedleDoesNotPassAThreadInSilence) {
  TextRun run = scene(
      "<SutureThread name='s' needle_length='20 mm' needle_angle='0' needle_beams='8' "
      "needle_diameter='0.3 mm' thread_length='0.2 mm' thread_beams='1' thread_diameter='0.1 mm' "
      "tip='0 0 0' tip_direction='-1 0 0' plane_normal='0 0 1'/>" +
          turning(1.5, 0.01) + "<Grasper body='s' at='0.5 mm' track='go'/>" +
          held(at_angle(0.018, 1.2)) + "<Contact first='s' second='a'/>",
      0.01);
  EXPECT_TRUE(says_so(run, 0.01) || run.number("/contact", "touches") > 0);
}

// Nothing is near: no step is divided, and none takes more than one pass.
TEST(Swept, WhatIsOutOfReachCostsNothing) {
  for (const auto& blade : {mesh_blade, box_blade, capsule_blade}) {
    TextRun run = scene(upright(at_angle(0.021, 0.25)) + turning(0.5, 0.05) + blade(0.013, 0.019) +
                            "<Contact tool='blade'/>",
                        0.05);
    const StepReport& report = run.simulation().step();
    EXPECT_FALSE(report.missed());
    EXPECT_EQ(report.parts, 1);
    EXPECT_EQ(report.passes, 1);
  }
}

// Where a step must not be divided it says what it does not know.
TEST(Swept, WithoutDivisionItIsAFault) {
  TextRun run("<plugin name='contact'/>" + upright(at_angle(0.018, 0.25)) + turning(0.5, 0.05) +
                  mesh_blade(0.013, 0.0185) + "<Contact tool='blade'/>",
              "dt='50 ms' gravity='0 0 0' substeps='1'");
  ASSERT_TRUE(run) << run.said();
  const StepReport& report = run.simulation().step();
  EXPECT_TRUE(report.missed());
  ASSERT_EQ(report.faults.size(), 1u);
}

}  // namespace
}  // namespace sutura::testing
