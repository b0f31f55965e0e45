// Two threads are pulled across each other and turned about each other, also through the angle at
// which touches at nodes take over from the touch at the nearest place: 30 degrees for straight
// ones, more for those that are bent round each other.
#include <gtest/gtest.h>

#include <numbers>
#include <sstream>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

/// One thread lies along x, its hands go down by `down`; the other lies at `from` degrees to it,
/// and its hands turn it to `to`.
std::string turned_threads(Real from, Real to, Real down, const std::string& more) {
  const auto point = [](Real degrees, Real radius) {
    const Real angle = degrees * std::numbers::pi / 180;
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), 0);
  };
  const auto text = [](const Vec3& v) {
    std::ostringstream out;
    out << v.x() << ' ' << v.y() << ' ' << v.z();
    return out.str();
  };
  const auto thread = [&](const std::string& name, Real degrees, Real height, int beams) {
    const Vec3 along = point(degrees, 1);
    return "<SutureThread name='" + name +
           "' needle_length='0' thread_young='2 GPa' thread_density='1100' "
           "thread_diameter='0.2 mm' bending_factor='0.05' damping_stiffness='0.1 ms' "
           "damping_mass='20 1/s' thread_length='20 mm' thread_beams='" +
           std::to_string(beams) + "' tip='" + text(0.01 * along + height * Vec3::UnitZ()) +
           "' tip_direction='" + text(along) + "' plane_normal='" + text(-point(degrees + 90, 1)) +
           "'/>";
  };
  const auto hand = [&](const std::string& body, bool first, const Vec3& way, Real begin,
                        Real end) {
    std::ostringstream out;
    const std::string name = body + (first ? "0" : "1");
    out << "<Track name='" << name << "_way' times='" << begin << ' ' << end
        << " s' positions='0 0 0 " << text(way) << "'/><Grasper name='" << name << "' body='"
        << body << "' track='" << name << "_way' at='" << (first ? 0 : 20)
        << " mm' rotation_stiffness='0'/>";
    return out.str();
  };
  const Vec3 turn = point(to, 0.01) - point(from, 0.01), pull(0, 0, -down);
  return "<plugin name='contact'/>" + thread("a", 0, 0.12e-3, 60) +
         thread("b", from, -0.12e-3, 67) + hand("a", true, pull, 0, 0.05) +
         hand("a", false, pull, 0, 0.05) + hand("b", true, turn, 0.05, 0.4) +
         hand("b", false, -turn, 0.05, 0.4) + "<Contact first='a' second='b' " + more + "/>";
}

TEST(TurningStrands, KeepTheForcesOfTheirTouches) {
  struct Turn {
    Real from, to;
    std::string friction;
  };
  const Turn turns[] = {{50, 70, "friction='0.3'"},
                        {70, 50, "friction='0'"},
                        {20, 40, "friction='0.3'"},
                        {40, 20, "friction='0'"}};
  for (const auto& [from, to, friction] : turns) {
    TextRun run(turned_threads(from, to, 6e-3, friction), "dt='5 ms' gravity='0 0 0'");
    ASSERT_TRUE(run) << run.said();
    int missed = 0, passes = 0;
    for (int step = 0; step < 90; ++step) {
      const StepReport& report = run.simulation().step();
      missed += !report.solved;
      passes += static_cast<int>(report.passes);
      // A twentieth of the thickness may stay between two touches. More is what a step that was not
      // solved has left, up to half of it, and it is said until it is taken back.
      const Real distance = run.number("/contact", "distance");
      EXPECT_GT(distance, -0.1e-3 - 1e-7) << step;
      EXPECT_TRUE(distance > -0.01e-3 || !report.solved || !report.faults.empty()) << step;
    }
    std::printf("%g to %g degrees, %s: %d of 90 steps missed their tolerance, %d passes\n", from,
                to, friction.c_str(), missed, passes);
    // Bent round each other at a right angle within a diameter, not all are solved. Where touches
    // lost their force between passes it was 51 and 81 of 90 steps, and 300 to 490 passes each.
    EXPECT_LE(missed, 20);
    EXPECT_LE(passes, 90 * 100);
  }
}

}  // namespace
}  // namespace sutura::testing
