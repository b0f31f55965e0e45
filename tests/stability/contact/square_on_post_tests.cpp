// A square knot tied round a post and drawn tight (5 ms). While the hands draw, its loop comes to a
// balance that is none: a saddle, which long steps can stay at, pulling half as much again. Held
// there by the better guesses of its passes and led away by all others, it never came to rest.
#include <gtest/gtest.h>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

std::string square_on_post() {
  const auto hand = [](const std::string& name, const char* at, const char* way) {
    return "<Track name='" + name + "_way' times='0 0.4 s' positions='0 0 0 " + way +
           " 0 0 mm' easing='smooth'/><Grasper name='" + name + "' at='" + at + "' track='" + name +
           "_way' rotation_stiffness='0'/>";
  };
  return "<plugin name='contact'/><SutureThread name='suture' needle_length='0' "
         "thread_young='2 GPa' thread_density='1100' thread_diameter='0.2 mm' "
         "bending_factor='0.05' damping_stiffness='0.1 ms' damping_mass='20 1/s' "
         "thread_length='65.534170 mm' thread_beams='100' sampling_angle='0.3 rad' "
         "shortest_beam='0.2 mm' tip='-9.7 0 1.72 mm' tip_direction='-1 0 0' "
         "plane_normal='0 -1 0' thread_start_file='" SUTURA_SOURCE_DIR
         "/tests/stability/contact/square_on_post.csv'/><Tool name='post' shape='box' "
         "size='10 30 2 mm' centre='0 0 -1.72 mm' rounding='0.9 mm' axis='0 0 1'/>"
         "<Contact name='itself' friction='0.3'/><Contact tool='post' friction='0.2'/>" +
         hand("left", "0", "-4") + hand("right", "65.534170 mm", "4") +
         "<EnergyProbe name='energy'/>";
}

TEST(SquareOnPost, ComesToRest) {
  TextRun world(square_on_post(), "dt='5 ms' gravity='0 0 0'");
  ASSERT_TRUE(world) << world.said();
  world.run(1);
  const auto work = [&] { return world.number("/energy", "work_of_constraints"); };
  const Real before = work();
  Real moves = 0;
  while (world.simulation().time() < 1.2) {
    world.simulation().step();
    moves = std::max(moves, world.number("/suture", "kinetic_energy"));
  }
  EXPECT_LT(moves, 1e-12);           // J; it was 3e-10
  EXPECT_LT(work() - before, 1e-9);  // J: touches only take energy; it was 2e-7
  EXPECT_NEAR(world.vector("/left", "force").norm(), 11e-3, 1e-3);  // as with 1 ms; it was 16
}

}  // namespace
}  // namespace sutura::testing
