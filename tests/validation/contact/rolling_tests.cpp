// A thread that spins rubs on one beside it until the two roll on each other.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "contact_scenes.h"
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

constexpr Real density = 1100, length = 10e-3;

/// Two straight threads of these radii side by side, held at their places but free to roll and
/// pressed together by an overlap; the first spins. Turned by `turn` about y as a whole.
std::string rolling_threads(Real ra, Real rb, Real spin, Real turn, const char* friction) {
  const Quat whole(Eigen::AngleAxis<Real>(turn, Vec3::UnitY()));
  const Vec3 along = whole * Vec3::UnitX(), across = whole * Vec3::UnitZ();
  constexpr Real overlap = 0.2e-6;
  const auto thread = [&](const std::string& name, Real radius, Real side, Real speed) {
    const Vec3 tip = length / 2 * along + side * (radius - overlap / 2) * across;
    return "<SutureThread name='" + name +
           "' needle_length='0' thread_young='2 GPa' thread_density='" + std::to_string(density) +
           "' thread_diameter='" + std::to_string(2 * radius) + "' thread_length='" +
           std::to_string(length) + "' thread_beams='10' tip='" + text_of(tip) +
           "' tip_direction='" + text_of(along) + "' plane_normal='0 1 0' spin='" +
           text_of(-speed * along) + "'/>";
  };
  std::string hands = "<Track name='still' times='0 1 s' positions='0 0 0 0 0 0'/>";
  for (const char* name : {"a", "b"})
    for (const char* at : {"0", "5", "10"})
      hands += std::string("<Grasper name='") + name + at + "' body='" + name +
               "' track='still' at='" + at + " mm' rotation_stiffness='0'/>";
  return "<plugin name='contact'/>" + thread("a", ra, 1, spin) + thread("b", rb, -1, 0) + hands +
         "<Contact name='contact' first='a' second='b' compliance='1 mm/N' friction='" + friction +
         "'/>";
}

// What the one loses in spin the other gets, times the ratio of the arms, until their surfaces go
// at one speed (a textbook's). A step takes them through up to 50 rad: by then what a point of the
// surface has gone says nothing about how far it has rolled.
TEST(RollingThreads, RubUntilTheyRollOnEachOther) {
  struct Case {
    Real spin, ra, rb, turn;
    const char* dt;
  };
  for (const Case& c : {Case{100, 1e-4, 1e-4, 0, "1 ms"}, Case{100, 1e-4, 1e-4, 0.7, "10 ms"},
                        Case{100, 1e-4, 1e-4, 0, "50 ms"}, Case{1000, 1e-4, 1e-4, 0, "50 ms"},
                        Case{100, 1e-4, 2e-4, 0, "20 ms"}, Case{300, 2e-4, 1e-4, 0, "50 ms"}}) {
    SCOPED_TRACE(std::to_string(c.spin) + " rad/s, " + c.dt);
    TextRun run(rolling_threads(c.ra, c.rb, c.spin, c.turn, "0.3"),
                std::string("gravity='0 0 0' dt='") + c.dt + "'");
    ASSERT_TRUE(run) << run.said();
    const Real begin = run.number("/a", "kinetic_energy");
    const auto mass = [](Real r) { return density * std::numbers::pi * r * r * length; };
    const Real ma = mass(c.ra), mb = mass(c.rb);
    EXPECT_NEAR(begin, ma * c.ra * c.ra / 4 * c.spin * c.spin, 1e-6 * begin);
    Real most = begin;
    while (run.simulation().time() < 0.8 - 1e-9) {
      EXPECT_TRUE(run.simulation().step().solved);
      most =
          std::max(most, run.number("/a", "kinetic_energy") + run.number("/b", "kinetic_energy"));
    }
    EXPECT_LT(most, begin * (1 + 1e-9));
    // With moments of inertia m r^2 / 2 and the impulse P of friction: a loses 2 P / (m r), b gets
    // as much, until r omega is the same.
    const Real P = c.ra * c.spin / (2 / ma + 2 / mb);
    const Real wa = c.spin - 2 * P / (ma * c.ra), wb = 2 * P / (mb * c.rb);
    // Hands of 1e6 N/m give way, and what little they turn takes 0.4 % of the energy.
    EXPECT_NEAR(run.number("/a", "kinetic_energy"), ma * c.ra * c.ra / 4 * wa * wa, 5e-3 * begin);
    EXPECT_NEAR(run.number("/b", "kinetic_energy"), mb * c.rb * c.rb / 4 * wb * wb, 5e-3 * begin);
  }
}

// A half-circle needle stands on a plane and is let go at a tilt of 0.15 rad. It rolls to and fro
// on its beams as a polygon with round corners does: at every corner it loses a little, and
// implicit Euler takes more, but nothing gives it energy. Its beams bulge towards the plane by up
// to half of the radius.
class Rocking : public ::testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(Rocking, NeverGainsEnergy) {
  const auto [beams, dt] = GetParam();
  TextRun run(
      "<plugin name='contact'/>"
      "<SutureThread name='s' needle_length='26.0124 mm' needle_angle='180 deg' "
      "needle_diameter='0.65 mm' thread_length='0.2 mm' thread_diameter='0.01 mm' "
      "thread_beams='1' needle_beams='" +
          std::string(beams) +
          "' needle_centre='0 0 8.605 mm' tip_angle='1.7208 rad' plane_normal='0 -1 0'/>"
          "<Tool name='low' shape='plane' axis='0 0 1'/>"
          "<Contact tool='low' friction='0.5'/><EnergyProbe name='e'/>",
      std::string("dt='") + dt + "'");
  ASSERT_TRUE(run) << run.said();
  const auto tilt = [&] {
    return run.vector("/s", "tip_position").z() - run.vector("/s", "end_position").z();
  };
  const Real start = run.number("/e", "total"), first = tilt();
  Real highest = start, swung = 0;
  while (run.simulation().time() < 0.4 - 1e-9) {
    EXPECT_TRUE(run.simulation().step().solved);
    highest = std::max(highest, run.number("/e", "total"));
    if (run.simulation().time() > 0.1) swung = std::max(swung, std::abs(tilt() / first));
  }
  // A fiftieth of what 68 mg gain that are lifted once by a dip of 5 % of the radius.
  EXPECT_LT(highest - start, 1e-4 * start);
  EXPECT_GT(swung, 0.3);  // it rocks
}

INSTANTIATE_TEST_SUITE_P(OnAPlane, Rocking,
                         ::testing::Combine(::testing::Values("8", "12", "24"),
                                            ::testing::Values("0.5 ms", "1 ms", "2.5 ms")));

}  // namespace
}  // namespace sutura::testing
