// A thread and blocks of tissue on an inclined plane: reference c01.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "contact_scenes.h"
#include "csv.h"
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

/// A thread of 20 mm that lies down the slope, its lower end at the origin; x leads down.
std::string thread_on_plane(Real degrees, Real mu, const std::string& more = "", Real speed = 0) {
  const Real angle = degrees * std::numbers::pi / 180;
  const Real down = std::cos(angle), drop = std::sin(angle), r = 0.1e-3;
  const auto vector = [](Real x, Real z) { return std::to_string(x) + " 0 " + std::to_string(z); };
  return "<plugin name='contact'/>"
         "<SutureThread name='suture' needle_length='0' thread='4-0 polypropylene' "
         "thread_diameter='0.2 mm' thread_length='20 mm' thread_beams='10' tip='" +
         vector(r * drop, r * down) + "' tip_direction='" + vector(down, -drop) + "' velocity='" +
         vector(speed * down, -speed * drop) + "'/><Tool name='plane' shape='plane' axis='" +
         vector(drop, down) + "'/><Contact tool='plane' friction='" + std::to_string(mu) + "' " +
         more + "/>";
}

TEST(Incline, SticksOrSlidesAsTheReferenceSays) {
  const Table reference = read_csv(SUTURA_SOURCE_DIR "/tests/reference/c01_incline.csv");
  int stuck = 0, slid = 0;
  for (std::size_t i = 0; i < reference.rows.size(); ++i) {
    const Real degrees = reference.number(i, "angle deg"), mu = reference.number(i, "mu");
    // At 45 degrees and mu = 1 both are right.
    if (std::abs(std::tan(degrees * std::numbers::pi / 180) - mu) < 1e-9) continue;
    TextRun run(thread_on_plane(degrees, mu), "dt='10 ms'");
    ASSERT_TRUE(run) << run.said();
    run.run(0.1);  // to rest, or to speed: vectors of the scene are written with six digits
    const Real before = run.vector("/suture", "tip_velocity").norm();
    const Vec3 at = run.vector("/suture", "tip_position");
    run.run(1.1);
    const Real gained = run.vector("/suture", "tip_velocity").norm() - before;
    const Real moved = (run.vector("/suture", "tip_position") - at).norm();
    if (reference.number(i, "sticks") > 0) {
      EXPECT_LT(moved, 1e-12) << degrees << ' ' << mu;
      ++stuck;
    } else {
      const Real expected = reference.number(i, "acceleration m/s2");
      EXPECT_NEAR(gained, expected, 1e-4 * 9.81) << degrees << ' ' << mu;
      ++slid;
    }
    // Whatever the slope, the plane feels the weight across it.
    const Real normal = reference.number(i, "normal force / m");
    const Real mass = 910 * std::numbers::pi * 0.1e-3 * 0.1e-3 * 20e-3;
    const Real angle = degrees * std::numbers::pi / 180;
    const Vec3 force = run.vector("/plane", "force");
    EXPECT_NEAR(-force.dot(Vec3(std::sin(angle), 0, std::cos(angle))), normal * mass,
                1e-3 * normal * mass);
  }
  EXPECT_GT(stuck, 7);
  EXPECT_GT(slid, 8);
}

/// A block of tissue of 10 x 8 x 6 mm that lies on the top of a tool which is inclined towards x,
/// turned by `turn` about the normal.
std::string block_on_tool(const std::string& tool, Real degrees, Real turn, Real mu,
                          const std::string& young) {
  const Eigen::AngleAxis<Real> tilt(degrees * std::numbers::pi / 180, Vec3::UnitY());
  std::string corners;
  for (const Real z : {0, 6})
    for (const Real y : {-4, 4})
      for (const Real x : {-5, 5})
        corners +=
            text_of(tilt * (Eigen::AngleAxis<Real>(turn, Vec3::UnitZ()) * Vec3(x, y, z))) + ' ';
  const std::string place =
      tool == "box" ? "size='40 1 0.02 m' centre='" + text_of(tilt * Vec3(0, 0, -0.01)) + "'" : "";
  return "<plugin name='contact'/><node name='block'><BlockMesh corners='" + corners +
         "mm' cells='3 2 2'/><Tissue name='tissue' young='" + young +
         "' poisson='0.45' density='1000' damping_stiffness='10 ms'/></node>"
         "<TissueProbe name='all' tissue='/block/tissue' box='-1 -1 -1 1 1 1'/>"
         "<Tool name='tool' shape='" +
         tool + "' axis='" + text_of(tilt * Vec3::UnitZ()) + "' " + place +
         "/><Contact first='/block/tissue' tool='tool' friction='" + std::to_string(mu) + "'/>";
}

// A block that is soft sinks together and wobbles first. Its mean then rests, or goes like that of
// a rigid one: friction is a share of the whole weight, however it is spread.
TEST(Incline, BlocksOfTissueStickOrSlideToo) {
  const Table reference = read_csv(SUTURA_SOURCE_DIR "/tests/reference/c01_incline.csv");
  for (std::size_t i = 0; i < reference.rows.size(); ++i) {
    const Real degrees = reference.number(i, "angle deg"), mu = reference.number(i, "mu");
    if (std::abs(std::tan(degrees * std::numbers::pi / 180) - mu) < 1e-9) continue;
    const std::string tool = i % 2 == 0 ? "plane" : "box", dt = i % 3 == 0 ? "20 ms" : "5 ms",
                      young = i % 5 < 2 ? "2 kPa" : "100 kPa";
    SCOPED_TRACE(tool + " of " + std::to_string(degrees) + " degrees, mu " + std::to_string(mu) +
                 ", " + young + ", " + dt);
    TextRun run(block_on_tool(tool, degrees, 0.3 * static_cast<Real>(i), mu, young),
                "dt='" + dt + "'");
    ASSERT_TRUE(run) << run.said();
    run.run(0.8);
    const Vec3 before = run.vector("/all", "velocity"), at = run.vector("/all", "position");
    run.run(1.8);
    if (reference.number(i, "sticks") > 0)
      EXPECT_LT((run.vector("/all", "position") - at).norm(), 1e-9);
    else  // what is left of the wobble; 1 % of the least of these accelerations is 0.01 m/s^2
      EXPECT_NEAR((run.vector("/all", "velocity") - before).norm(),
                  reference.number(i, "acceleration m/s2"), 1e-3);
  }
}

// Between the two coefficients: what lies still stays, what slides is dragged by the lower one.
// Above both it breaks away, and is dragged by the lower one from the first step on.
TEST(Incline, HoldsMoreAtRestThanItDrags) {
  constexpr Real g = 9.81, mu = 0.3;
  const std::string held = "static_friction='0.5'";
  struct Case {
    Real degrees, speed;
    bool slides;
  };
  for (const Case& c : {Case{22, 0, false}, Case{22, 0.05, true}, Case{30, 0, true}}) {
    const Real angle = c.degrees * std::numbers::pi / 180;
    TextRun run(thread_on_plane(c.degrees, mu, held, c.speed), "dt='10 ms'");
    ASSERT_TRUE(run) << run.said();
    run.run(0.3);
    const Vec3 begin = run.vector("/suture", "tip_velocity"),
               at = run.vector("/suture", "tip_position");
    run.run(0.8);
    const Real gained = (run.vector("/suture", "tip_velocity") - begin).norm();
    if (c.slides)
      EXPECT_NEAR(gained, 0.5 * g * (std::sin(angle) - mu * std::cos(angle)), 1e-4 * g);
    else
      EXPECT_LT((run.vector("/suture", "tip_position") - at).norm(), 1e-9);
  }
  // Slowed down on a slope between the two, it comes to rest and stays, for good.
  TextRun run(thread_on_plane(15, mu, held, 0.1), "dt='10 ms'");
  ASSERT_TRUE(run) << run.said();
  run.run(0.5);
  EXPECT_LT(run.vector("/suture", "tip_velocity").norm(), 1e-9);
  TextRun wrong(thread_on_plane(20, mu, "static_friction='0.2'"));
  EXPECT_NE(wrong.said().find("less than 'friction'"), std::string::npos);
  EXPECT_TRUE(TextRun(thread_on_plane(20, mu, "static_friction='0'"))) << "0: there is none";
}

// Across the slope a thread rolls like a cylinder, with two thirds of the acceleration without
// friction, as long as a third of the slope is less than the friction; else it slips and is dragged
// (a textbook's: m a = m g sin - F, a r m / 2 = F r). A thin one makes tens of turns in a step, and
// must not get energy from what it takes up as turns.
TEST(Incline, AThreadAcrossItRolls) {
  struct Case {
    Real degrees, mu, thickness_mm;
    const char* dt;
  };
  for (const Case& c :
       {Case{20, 0.5, 0.2, "10 ms"}, Case{20, 0.5, 0.2, "1 ms"}, Case{20, 0.5, 0.05, "10 ms"},
        Case{10, 0.3, 0.5, "5 ms"}, Case{40, 0.3, 0.2, "20 ms"}, Case{20, 0.5, 0.2, "50 ms"},
        Case{30, 0.1, 0.2, "2.5 ms"}, Case{50, 0.3, 0.2, "10 ms"}}) {
    SCOPED_TRACE(std::to_string(c.degrees) + ' ' + std::to_string(c.mu) + ' ' +
                 std::to_string(c.thickness_mm) + ' ' + c.dt);
    const Real angle = c.degrees * std::numbers::pi / 180;
    const Vec3 normal(std::sin(angle), 0, std::cos(angle));
    TextRun run(
        "<plugin name='contact'/>"
        "<SutureThread name='suture' needle_length='0' thread='4-0 polypropylene' "
        "thread_length='20 mm' thread_beams='10' tip_direction='0 1 0' thread_diameter='" +
            std::to_string(c.thickness_mm) + " mm' tip='" +
            text_of(c.thickness_mm / 2 * normal - Vec3(0, 10, 0)) +
            " mm'/><Tool name='plane' shape='plane' axis='" + text_of(normal) +
            "'/><Contact tool='plane' friction='" + std::to_string(c.mu) + "'/>",
        std::string("dt='") + c.dt + "'");
    ASSERT_TRUE(run) << run.said();
    constexpr Real g = 9.81;
    const Real begin = run.number("/suture", "kinetic_energy"),
               high = run.vector("/suture", "tip_position").z();
    run.run(0.1);
    const Vec3 before = run.vector("/suture", "tip_velocity");
    run.run(0.5);
    const Real gained = (run.vector("/suture", "tip_velocity") - before).norm() / 0.4;
    const bool rolls = std::tan(angle) < 3 * c.mu;
    const Real expected =
        rolls ? 2. / 3 * g * std::sin(angle) : g * (std::sin(angle) - c.mu * std::cos(angle));
    EXPECT_NEAR(gained, expected, 1e-3 * expected);
    const Real mass = 910 * std::numbers::pi * std::pow(c.thickness_mm / 2000, 2) * 20e-3;
    EXPECT_LT(run.number("/suture", "kinetic_energy") - begin,
              mass * g * (high - run.vector("/suture", "tip_position").z()));
  }
}

// What each step may be off its law must not add up.
TEST(Incline, DoesNotCreepInAMinute) {
  TextRun run(thread_on_plane(20, 0.37), "dt='10 ms'");
  ASSERT_TRUE(run) << run.said();
  run.run(0.1);
  const Vec3 at = run.vector("/suture", "tip_position");
  run.run(60);
  EXPECT_LT((run.vector("/suture", "tip_position") - at).norm(), 1e-9);
  EXPECT_LT(run.number("/suture", "kinetic_energy"), 1e-25);
}

}  // namespace
}  // namespace sutura::testing
