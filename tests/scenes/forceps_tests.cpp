// Forceps take what is between their jaws, and hold it up to their strength: forces against
// balance.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenes/text_run.h"
#include "sutura/end_note.h"
#include "sutura/geometry/box_tree.h"
#include "sutura/geometry/curve_segments.h"
#include "sutura/tool.h"

namespace sutura::testing {
namespace {

// 0.2 mm polypropylene of 60 mm along x, its middle at the origin.
const std::string thread =
    "<SutureThread name='thread' needle_length='0' thread='4-0 polypropylene' thread_diameter='0.2 "
    "mm' thread_length='60 mm' thread_beams='30' tip='-30 0 0 mm' "
    "tip_direction='-1 0 0' damping_stiffness='0.1 ms'/>";

std::string pull(Real newtons, const std::string& more = "") {
  return thread.substr(0, thread.size() - 2) + more + "/><ThreadLoad at='60 mm' force='" +
         std::to_string(newtons) + " 0 0 N'/>";
}

TEST(Forceps, TakeTheStrandsThatAreBetweenThem) {
  const auto pieces = [](const std::string& where) {
    TextRun run(thread +
                "<SutureThread name='other' needle_length='0' thread_length='60 mm' tip='-30 3 0 "
                "mm' tip_direction='-1 0 0'/><Forceps " +
                where + "/>");
    EXPECT_TRUE(run) << run.said();
    run.run(0.02);
    return run.number("/forceps", "pieces");
  };
  EXPECT_EQ(pieces("centre='5 0 0 mm'"), 1);
  EXPECT_EQ(pieces("centre='5 1.5 0 mm' size='2 4 2 mm'"), 2);
  EXPECT_EQ(pieces("centre='5 1.5 0 mm' size='2 4 2 mm' body='/other'"), 1);
  EXPECT_EQ(pieces("centre='5 -2 0 mm'"), 0);
}

// A strand that leaves the jaws through their faces across 'axis' was taken anew in every step at
// the height at which it was grasped, and so let through by what the grip gives way in a step.
TEST(Forceps, HoldAStrandThatLiesAlongTheirAxis) {
  for (const char* axis : {"1 0 0", "0.6 0 0.8"})
    for (const char* dt : {"1 ms", "10 ms"}) {
      TextRun run(pull(0.02) + std::string("<Forceps centre='5 0 0 mm' size='2 2 0.5 mm' axis='") +
                      axis + "' strength='50 N'/>",
                  std::string("dt='") + dt + "' gravity='0 0 0'");
      ASSERT_TRUE(run) << run.said();
      const auto place = [&] {
        return run.component<SegmentedCurve>("/thread").point(35e-3, Configuration::current);
      };
      run.run(0.5);
      const Vec3 before = place();
      run.run(1);
      // It crept by 20 nm a step, the load over the stiffness.
      EXPECT_LT((place() - before).norm(), 1e-9) << axis << ", " << dt;
      EXPECT_LT((before - Vec3(5e-3, 0, 0)).norm(), 1e-6) << axis << ", " << dt;
    }
}

// What lies aside between the jaws is in their middle when they are closed, at a constant pace.
TEST(Forceps, BringWhatTheyTakeToTheirMiddle) {
  const auto heights = [](const std::string& closing) {
    TextRun run(thread + "<Forceps centre='5 0.2 0.6 mm' size='2 2 2 mm' grasp='0.1 s' " + closing +
                "/>");
    EXPECT_TRUE(run) << run.said();
    std::vector<Vec3> at;
    for (const Real time : {0.1, 0.15, 0.2, 0.3}) {
      run.run(time);
      at.push_back(run.component<SegmentedCurve>("/thread").point(35e-3, Configuration::current));
    }
    return at;
  };
  const std::vector<Vec3> drawn = heights("closing='0.1 s'"), left = heights("");
  constexpr Real off = 1e-6;  // m: of the grip's spring, and of a step's tolerance
  EXPECT_LT(std::abs(drawn[0].z()), off);
  EXPECT_NEAR(drawn[1].z(), 0.3e-3, off);
  EXPECT_NEAR(drawn[2].z(), 0.6e-3, off);
  EXPECT_NEAR(drawn[3].z(), 0.6e-3, off);
  for (const Vec3& p : drawn) EXPECT_LT(std::abs(p.y()), off);  // along the jaws nothing draws
  for (const Vec3& p : left) EXPECT_LT(p.tail<2>().norm(), off);
}

// Two threads, b under a and turned against it, touch where they are pressed together.
std::string two_threads(Real degrees, const std::string& more = "") {
  const auto one = [&](const std::string& name, Real z, Real turn) {
    const std::string x = std::to_string(std::cos(turn)), y = std::to_string(std::sin(turn));
    return "<SutureThread name='" + name +
           "' needle_length='0' thread='4-0 polypropylene' thread_diameter='0.2 mm' "
           "thread_length='60 mm' thread_beams='30' damping_stiffness='0.1 ms' tip='" +
           std::to_string(-30 * std::cos(turn)) + " " + std::to_string(-30 * std::sin(turn)) + " " +
           std::to_string(z) + " mm' tip_direction='-" + x + " -" + y + " 0' " + more + "/>";
  };
  return "<plugin name='contact'/>" + one("a", 0.7, 0) +
         one("b", -0.3, degrees * std::numbers::pi / 180) +
         "<Contact first='a' second='b' friction='0.3'/>"
         "<Forceps size='2 2 2 mm' strength='2 N' closing='0.1 s'/>";
}

// Strands between closed jaws lie on each other, about their middle, and nothing squeezes them:
// what is there of force between them is what a step may leave.
class Strands : public ::testing::TestWithParam<int> {};

TEST_P(Strands, AreLaidOnEachOtherWithoutForce) {
  TextRun run(two_threads(GetParam()));
  ASSERT_TRUE(run) << run.said();
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(run.simulation().step().solved) << i;
    EXPECT_EQ(run.number("/forceps", "pieces"), 2);
    EXPECT_LT(run.number("/contact", "largest_force"), 1e-3) << i;
  }
  const auto height = [&](const char* name) {
    return run.component<SegmentedCurve>(name).point(30e-3, Configuration::current).z();
  };
  EXPECT_NEAR(height("/a") - height("/b"), 0.202e-3, 1e-6);
  EXPECT_NEAR(height("/a") + height("/b"), 0, 1e-6);
}

// So the one is drawn out against its share of the strength, and the other does not move: the rest
// is momentum.
TEST_P(Strands, AreDrawnOutOneByOne) {
  TextRun run(two_threads(GetParam(), "thread_density='910000'") +
              "<ThreadLoad thread='a' at='60 mm' force='1.001 0 0 N' times='0.1 0.2 s' "
              "factors='0 1'/>");
  ASSERT_TRUE(run) << run.said();
  run.run(0.3);
  constexpr Real dt = 0.01;
  const auto momentum = [&](const char* name) { return run.vector(name, "momentum").x(); };
  Real a = momentum("/a");
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(run.simulation().step().solved);
    EXPECT_NEAR(run.vector("/forceps", "force").x(), -1, 1e-3);
    EXPECT_NEAR(momentum("/a") - a, dt * 0.001, 0.01 * dt * 0.001);
    EXPECT_LT(std::abs(momentum("/b")), dt * 1e-5);
    a = momentum("/a");
  }
}
INSTANTIATE_TEST_SUITE_P(Angles, Strands, ::testing::Values(0, 20, 90),
                         [](const auto& info) { return std::to_string(info.param); });

// Saved while they close, they go on to the same bits.
TEST(Forceps, CloseOnAsIfTheyHadNotBeenSaved) {
  TextRun run(two_threads(20)), other(two_threads(20));
  ASSERT_TRUE(run && other) << run.said();
  run.run(0.05);
  ASSERT_EQ(other.simulation().restore(run.simulation().save()), "");
  run.run(0.2);
  other.run(0.2);
  EXPECT_EQ(run.simulation().save(), other.simulation().save());
}

// Tissue that is held keeps the jaws apart: nothing is drawn into it.
TEST(Forceps, LeaveAThreadOnTissueWhereItIs) {
  TextRun run(
      "<plugin name='contact'/><BlockMesh box='-5 -5 -4  5 5 0 mm' cells='5 5 2'/>"
      "<Tissue name='tissue' young='50 kPa' poisson='0.3' damping_stiffness='10 ms'/>"
      "<Attach box='-5 -5 -4  5 5 -4 mm'/><Contact first='thread' second='tissue'/>" +
      thread.substr(0, thread.find("tip=")) +
      "tip='-30 0 0.1 mm' tip_direction='-1 0 0'/>"
      "<Forceps centre='0 0 -0.5 mm' size='2 2 2 mm' closing='0.1 s'/>");
  ASSERT_TRUE(run) << run.said();
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(run.simulation().step().solved) << i;
    EXPECT_LT(run.number("/contact", "largest_force"), 1e-3) << i;
  }
  EXPECT_EQ(run.number("/forceps", "pieces"), 2);
}

// Whatever the direction in which they close, across the thread.
class Grip : public ::testing::TestWithParam<const char*> {
 protected:
  std::string forceps(const std::string& more) {
    return std::string("<Forceps centre='10.3 0 0 mm' size='2 2 2 mm' strength='0.5 N' axis='") +
           GetParam() + "' " + more + "/>";
  }
};

TEST_P(Grip, HoldsWithoutCreepBelowItsStrength) {
  TextRun run(pull(0.49) + forceps(""));
  ASSERT_TRUE(run) << run.said();
  run.run(0.5);
  const Real held = run.vector("/thread", "end_position").x();
  EXPECT_EQ(run.number("/forceps", "sliding"), 0);
  // A hundredth of the forces at work is what a step may leave; at rest it leaves much less.
  EXPECT_NEAR(run.vector("/forceps", "force").x(), -0.49, 1e-4);
  run.run(20);
  EXPECT_NEAR(run.vector("/thread", "end_position").x(), held, 1e-9);
}

// What the jaws take of the pull is their strength, in every step: the rest is momentum.
TEST_P(Grip, SlidesAtItsStrengthBeyond) {
  // A thousand times as heavy as it is: it does not leave the jaws within a step.
  TextRun run(pull(0.501, " thread_density='910000'") + forceps(""));
  ASSERT_TRUE(run) << run.said();
  run.run(0.1);
  constexpr Real dt = 0.01;
  Real before = run.vector("/thread", "momentum").x();
  for (int i = 0; i < 20; ++i) {
    run.simulation().step();
    ASSERT_TRUE(run.simulation().report().solved);
    EXPECT_EQ(run.number("/forceps", "sliding"), 1);
    EXPECT_NEAR(run.vector("/forceps", "force").x(), -0.5, 1e-6);
    const Real now = run.vector("/thread", "momentum").x();
    EXPECT_NEAR(now - before, dt * 0.001, 0.01 * dt * 0.001);  // to the tolerance of a step
    before = now;
  }
}
INSTANTIATE_TEST_SUITE_P(Axes, Grip, ::testing::Values("0 1 0", "0 0 1", "0 1 1", "0 -1 2"),
                         [](const auto& info) { return std::to_string(info.index); });

// Closed jaws that are drawn along a thread that is held at its start: their strength is its
// tension, until its end comes out.
TEST(Forceps, ThreadIsPulledThroughUntilItsEnd) {
  const std::string held = thread.substr(0, thread.size() - 2) + " clamp='start'/>";
  TextRun run(held +
              "<Track times='0 1 s' positions='0 0 0  50 0 0 mm'/>"
              "<Forceps centre='0 0 0' axis='0 1 0' size='2 2 2 mm' strength='0.3 N'/>");
  ASSERT_TRUE(run) << run.said();
  for (int i = 0; i < 100; ++i) {
    const auto& report = run.simulation().step();
    ASSERT_TRUE(report.solved) << report.time;
    // The end is at 30 mm, jaws of 2 mm have passed it at 31: they are there at 0.62 s. The thread
    // is longer by its strain, T / (E A).
    if (report.time > 0.635) {
      EXPECT_EQ(run.number("/forceps", "pieces"), 0) << report.time;
      EXPECT_EQ(run.vector("/forceps", "force").norm(), 0);
    } else if (report.time > 0.015 && report.time < 0.615) {
      EXPECT_NEAR(run.vector("/forceps", "force").x(), 0.3, 1e-3) << report.time;
    }
  }
}

// A turn of the jaws turns the thread in them: they hold it against run sides.
TEST(Forceps, StrandsDoNotRollInTheJaws) {
  TextRun run(thread +
              "<Track times='0 0.5 s' rotations='0 0 0  90 0 0 deg'/>"
              "<Forceps axis='0 1 0' size='2 2 2 mm'/>");
  ASSERT_TRUE(run) << run.said();
  auto& curve = run.component<CurveBody>("/thread");
  const Quat before = curve.frame(0.03, Configuration::current).rotation;
  run.run(0.6);
  const Quat turn = curve.frame(0.03, Configuration::current).rotation * before.conjugate();
  EXPECT_NEAR(2 * std::atan2(turn.x(), turn.w()), std::numbers::pi / 2, 1e-3);
}

std::string block(const char* cells, const char* way = "10") {
  return std::string("<BlockMesh box='0 -5 -2  20 5 0 mm' cells='") + cells +
         "'/><Tissue name='tissue' young='50 kPa' poisson='0.3' damping_stiffness='10 ms'/>"
         "<Attach name='root' box='0 -5 -2  0 5 0 mm'/>"
         "<Track name='hand' times='0 1 s' positions='0 0 0  " +
         way + " 0 0 mm'/>";
}

// A strip of tissue is pulled at its end. The pull grows to the strength, on any mesh, until the
// strip has slipped out.
class Strip : public ::testing::TestWithParam<const char*> {};

TEST_P(Strip, SlipsOutAtTheStrength) {
  TextRun run(block(GetParam(), "20") +
              "<Forceps centre='18.6 0 -1 mm' size='3 12 4 mm' strength='0.3 N'/>");
  ASSERT_TRUE(run) << run.said();
  Real most = 0;
  bool lost = false;
  for (int i = 0; i < 100; ++i) {
    const auto& report = run.simulation().step();
    ASSERT_TRUE(report.solved) << report.time;
    const Real force = run.vector("/forceps", "force").x();
    // The root bears what the jaws pull; the mass of 0.4 g at 20 mm/s takes a little.
    EXPECT_NEAR(run.vector("/root", "reaction").x(), -force, 0.02) << report.time;
    // The springs of single points pull along their own ways, which narrow with the strip: the sum
    // of their forces is a little less than their number.
    EXPECT_LT(force, 0.3 + 1e-9);
    most = std::max(most, force);
    if (force > 0 && lost) ADD_FAILURE() << "what is out is out";
    lost = lost || run.number("/forceps", "pieces") == 0;
  }
  EXPECT_GT(most, 0.98 * 0.3);
  EXPECT_TRUE(lost);
}
INSTANTIATE_TEST_SUITE_P(Meshes, Strip, ::testing::Values("5 3 2", "10 5 2", "16 8 3"),
                         [](const auto& info) { return std::to_string(info.index); });

// Below it they hold, and the strip is longer by what the jaws have moved.
TEST(Forceps, CarryTissueBelowTheirStrength) {
  TextRun run(block("10 5 2") +
              "<Forceps centre='19 0 -1 mm' size='3 12 4 mm' strength='50 N' release='1.2 s'/>"
              "<TissueProbe name='end' point='20 0 0 mm'/>");
  ASSERT_TRUE(run) << run.said();
  run.run(1.2);
  EXPECT_EQ(run.number("/forceps", "sliding"), 0);
  // The end is beyond the last points that are held, half an element away: it stays behind a
  // little.
  EXPECT_NEAR(run.vector("/end", "displacement").x(), 10e-3, 5e-5);
  run.run(3);
  EXPECT_EQ(run.number("/forceps", "pieces"), 0);
  EXPECT_NEAR(run.vector("/end", "displacement").x(), 0, 1e-5);
}

TEST(Forceps, DoAsAHostSays) {
  TextRun run(thread + "<Forceps grasp='100 s'/>");
  ASSERT_TRUE(run) << run.said();
  auto& jaws = run.component<Jaws>("/forceps");
  run.simulation().step();
  EXPECT_FALSE(jaws.holding());
  jaws.grasp();
  run.simulation().step();
  EXPECT_TRUE(jaws.holding());
  EXPECT_EQ(run.number("/forceps", "pieces"), 1);
  jaws.release();
  run.simulation().step();
  EXPECT_EQ(run.number("/forceps", "pieces"), 0);
}

// What they close on late, or at all, is no news; that they never did is.
TEST(Forceps, SayAtTheEndThatTheyNeverHeldAnything) {
  const auto note = [](const std::string& more, Real until = 0.05) {
    TextRun run(thread +
                "<Track times='0 0.02 s' positions='0 0 9 0 0 0 mm'/><Forceps centre='5 0 0 mm' " +
                more + "/>");
    EXPECT_TRUE(run) << run.said();
    run.run(until);
    return dynamic_cast<const EndNote&>(*run.simulation().find("/forceps")).end_note();
  };
  EXPECT_EQ(note("grasp='0'"),
            "closed at 0 s, when their centre was at 5 0 9 mm, and neither thread nor tissue was "
            "between them");
  EXPECT_EQ(note("grasp='0 0.01 s' release='5 20 ms'").find("closed 2 times, first at 0 s"), 0u);
  EXPECT_EQ(note("grasp='0 0.03 s' release='5 ms'"), "");
  EXPECT_EQ(note("grasp='0.03 s' release='0.04 s'"), "");
  EXPECT_EQ(note("grasp='1 s'"), "");  // they have not closed yet
}

// As 'axis' of Forceps, Scissors and Tool says: the shortest turn from z takes x and y along.
TEST(Forceps, TheEdgesOfTheirSpaceLieAsTheAxisSays) {
  const auto lies = [](const std::string& axis, const Vec3& extent) {
    TextRun run("<plugin name='contact'/>" + thread + "<Forceps size='1 2 3 mm' axis='" + axis +
                "'/><Tool shape='box' size='1 2 3 mm' axis='" + axis + "'/>");
    ASSERT_TRUE(run) << run.said();
    for (const char* path : {"/forceps", "/tool"}) {
      const auto* drawing = dynamic_cast<const Drawing*>(run.simulation().find(path));
      ASSERT_NE(drawing, nullptr);
      Box box;
      for (const Vec3& p : drawing->geometry().points) box.add(p);
      EXPECT_LT((box.high - box.low - 1e-3 * extent).norm(), 1e-12) << path << " " << axis;
    }
  };
  lies("0 0 1", {1, 2, 3});
  lies("1 0 0", {3, 2, 1});
  lies("0 1 0", {1, 3, 2});
}

TEST(Forceps, SayWhatIsWrong) {
  EXPECT_NE(TextRun("<Forceps/>").said().find("no thread and no tissue"), std::string::npos);
  EXPECT_NE(TextRun(thread + "<Forceps axis='0 0 0'/>").said().find("'axis' is zero"),
            std::string::npos);
  EXPECT_NE(TextRun(thread + "<Forceps grasp='1 2 s'/>").said().find("release"), std::string::npos);
}

}  // namespace
}  // namespace sutura::testing
