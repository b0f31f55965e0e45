// Shots at 5 m/s at threads, bars, tissue and at itself: nothing passes through anything, whatever
// the step, the speed, the materials and the friction. Judged by what crosses what and by where
// things are, not by the code that prevents it. SUTURA_SHOTS=200 makes a thousand of each kind.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <random>

#include "contact_scenes.h"
#include "scenes/text_run.h"
#include "stability/contact/crossings.h"

namespace sutura::testing {
namespace {

int shots() {
  const char* asked = std::getenv("SUTURA_SHOTS");
  return asked != nullptr ? std::atoi(asked) : 4;
}

/// What differs from shot to shot.
class Luck {
 public:
  explicit Luck(int seed) : random_(static_cast<unsigned>(seed)) {}
  Real between(Real low, Real high) {
    return std::uniform_real_distribution<Real>(low, high)(random_);
  }
  /// Across the x axis by 17 to 163 degrees.
  Vec3 across() {
    const Real angle = between(0.3, 2.84);
    return Vec3(std::cos(angle), std::sin(angle), 0);
  }
  std::string friction() { return "friction='" + std::to_string(between(0, 1)) + "'"; }
  /// From 10 to 500 um thick: 10-0 to 2, of steel to braid.
  std::string material() {
    thickness = 1e-5 * std::pow(50., between(0, 1));
    return "thread_diameter='" + std::to_string(thickness) + "' thread_young='" +
           std::to_string(std::pow(10., between(8.5, 11.3))) + "' ";
  }
  Real thickness = 0;  ///< of the last material (m)

 private:
  std::mt19937 random_;
};

/// A straight thread that flies down.
std::string flying(Luck& luck, Real height) {
  const Vec3 middle(luck.between(-0.01, 0.01), luck.between(-5e-3, 5e-3),
                    height + luck.between(0, 0.03));
  const Vec3 along = luck.across();
  return "<SutureThread name='a' needle_length='0' thread='4-0 polypropylene' " + luck.material() +
         "thread_length='20 mm' thread_beams='20' tip='" + text_of(middle - 0.01 * along) +
         "' tip_direction='" + text_of(-along) + "' velocity='0 0 -5'/>";
}

class Shot : public ::testing::TestWithParam<const char*> {
 protected:
  /// Seeds of this step length: no two tests have the same.
  int first_seed(int kind) const { return 100000 * kind + 1000 * std::atoi(GetParam()); }
  /// No step is divided: what is accepted lies straight ahead of where the step began, and that is
  /// what the judge looks along. It is also the harder case: steps that bounce are not solved then.
  std::string settings() const {
    return std::string("dt='") + GetParam() + "' gravity='0 0 0' substeps='1'";
  }
  /// Steps until `seconds`; `judge` looks at every end of a step.
  template <class Judge>
  void run(TextRun& world, Real seconds, const Judge& judge) {
    while (world.simulation().time() < seconds - 1e-9) {
      const StepReport& report = world.simulation().step();
      ASSERT_TRUE(report.finite);
      ++steps_;
      unsolved_ += !report.solved;
      judge();
    }
  }
  void TearDown() override {
    std::printf("%s: %d of %d steps said that they missed their tolerance\n", GetParam(), unsolved_,
                steps_);
  }

 private:
  int steps_ = 0, unsolved_ = 0;
};

TEST_P(Shot, AtAThread) {
  for (int i = 0; i < shots(); ++i) {
    Luck luck(first_seed(1) + i);
    const std::string shot = flying(luck, 1e-3);
    TextRun world("<plugin name='contact'/>" + shot +
                      thread("b", Vec3::Zero(), Vec3::UnitX(), 0.06, 60, "clamp='both'") +
                      "<Contact first='a' second='b' " + luck.friction() + "/>",
                  settings());
    ASSERT_TRUE(world) << world.said();
    const auto &a = world.component<SegmentedCurve>("/a"),
               &b = world.component<SegmentedCurve>("/b");
    Line a0 = line_of(a), b0 = line_of(b);
    run(world, 0.05, [&] {
      const Line a1 = line_of(a), b1 = line_of(b);
      EXPECT_EQ(crossings(a0, a1, b0, b1, false), 0) << i;
      a0 = a1, b0 = b1;
    });
  }
}

// At a bar of 0.02 to 1 mm: no point of the thread is ever inside of it, and as its ends are far
// apart from each other a thread that has not slid off is bent round it.
TEST_P(Shot, AtABar) {
  for (int i = 0; i < shots(); ++i) {
    Luck luck(first_seed(2) + i);
    const std::string shot = flying(luck, 2e-3);
    const Real radius = luck.between(0.02e-3, 1e-3), r = luck.thickness / 2;
    TextRun world("<plugin name='contact'/>" + shot +
                      "<Tool name='bar' shape='cylinder' axis='1 0 0' length='200 mm' radius='" +
                      std::to_string(radius) + "'/><Contact tool='bar' " + luck.friction() + "/>",
                  settings());
    ASSERT_TRUE(world) << world.said();
    const auto& a = world.component<SegmentedCurve>("/a");
    const Line bar{Vec3(-0.1, 0, 0), Vec3(0.1, 0, 0)};
    Line before = line_of(a);
    run(world, 0.05, [&] {
      const Line now = line_of(a);
      for (const Vec3& p : now) EXPECT_GT(std::hypot(p.y(), p.z()), radius + r / 4) << i;
      EXPECT_EQ(crossings(before, now, bar, bar, false), 0) << i;
      before = now;
    });
  }
}

// At a block of tissue on its bed.
TEST_P(Shot, AtTissue) {
  for (int i = 0; i < shots(); ++i) {
    Luck luck(first_seed(3) + i);
    const std::string shot = flying(luck, 1e-3);
    TextRun world(
        "<plugin name='contact'/>" + shot +
            block("skin", "-24 -16 -8 24 16 0", "8 6 2", "<Attach box='-24 -16 -8 24 16 -8 mm'/>") +
            "<Contact first='a' second='/skin/tissue' " + luck.friction() + "/>",
        settings());
    ASSERT_TRUE(world) << world.said();
    const auto& a = world.component<SegmentedCurve>("/a");
    const auto& skin = world.component<SolidBody>("/skin/tissue");
    run(world, 0.03, [&] {
      for (const Vec3& p : line_of(a))
        EXPECT_FALSE(skin.locate(p, Configuration::current)) << i << ' ' << p.transpose();
    });
  }
}

// A loop, one turn and a quarter, is thrown flat on a table: one end comes down on the other.
TEST_P(Shot, ALoopAtItself) {
  for (int i = 0; i < shots(); ++i) {
    Luck luck(first_seed(4) + i);
    const std::string material = luck.material();
    const Real R = luck.between(3e-3, 6e-3), r = luck.thickness / 2;
    const Real rise = (2.2 * r + luck.between(0, 1e-3)) / (2 * std::numbers::pi);
    const Real square = R * R + rise * rise, length = 2.5 * std::numbers::pi * std::sqrt(square);
    const std::string file =
        std::string(SUTURA_BINARY_DIR "/loop_") + std::to_string(first_seed(4)) + ".csv";
    std::ofstream(file) << std::setprecision(17) << "s [m],curvature [1/m],torsion [1/m]\n0,"
                        << R / square << ',' << rise / square << '\n';
    TextRun world(
        "<plugin name='contact'/><SutureThread name='a' needle_length='0' thread='4-0 "
        "polypropylene' " +
            material + "thread_length='" + std::to_string(length) +
            "' thread_beams='50' tip='0 0 0.01' tip_direction='" +
            text_of(Vec3(-R, 0, luck.between(-0.1, 0.1) * R)) + "' velocity='0 0 -5' " +
            "thread_start_file='" + file + "'/><Tool name='table' shape='plane'/>" +
            "<Contact name='on_table' first='a' tool='table' " + luck.friction() +
            "/><Contact name='itself' first='a' " + luck.friction() + "/>",
        settings());
    ASSERT_TRUE(world) << world.said();
    const auto& a = world.component<SegmentedCurve>("/a");
    Line before = line_of(a);
    run(world, 0.03, [&] {
      const Line now = line_of(a);
      EXPECT_EQ(crossings(before, now, before, now, true), 0) << i;
      for (const Vec3& p : now) EXPECT_GT(p.z(), r / 4) << i;
      before = now;
    });
  }
}

INSTANTIATE_TEST_SUITE_P(AtAnyStep, Shot,
                         ::testing::Values("1 ms", "5 ms", "10 ms", "20 ms", "50 ms"));

}  // namespace
}  // namespace sutura::testing
