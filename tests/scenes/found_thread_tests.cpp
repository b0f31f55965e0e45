// Faults of threads that testers found with scenes of their own (docs/validation/testers.md).
#include <cmath>
#include <numbers>

#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

const std::string hanging =
    "<SutureThread name='s' needle_length='0' tip_direction='0 0 1' plane_normal='0 1 0' "
    "thread_length='100 mm' thread_beams='20' thread_young='10 MPa' thread_density='20000' "
    "clamp='start' ";

// Below the cut 70 mm fall freely, fibres that lock at a strain or not: g t^2 / 2 and what implicit
// Euler adds, g t h / 2, in 0.2 s.
TEST(ElongationOf, AThreadThatIsCutLetsItFall) {
  for (const char* interval : {"1", "4"}) {
    TextRun run(
        hanging + "/><Elongation limit='0.001' interval='" + interval +
            "'/><Scissors centre='0 0 -32.5 mm' axis='1 0 0' size='4 4 2 mm' times='0.1 s'/>",
        "dt='5 ms'");
    ASSERT_TRUE(run) << run.said();
    run.run(0.1);
    const Real from = run.vector("/s", "end_position").z();
    run.run(0.3);
    EXPECT_EQ(run.number("/s", "cuts"), 1);
    const Real fall = 9.81 * 0.2 * 0.2 / 2 + 9.81 * 0.2 * 0.005 / 2;
    // The piece springs back as it is cut: by 0.1 % of its length, and less after that.
    EXPECT_NEAR(from - run.vector("/s", "end_position").z(), fall, 0.01 * fall) << interval;
  }
}

// What hangs below the clamp weighs 0.472 mN. Nearly all of that is borne by the limit, and it is
// tension as much as that of the elastic thread.
TEST(ElongationOf, AThreadTearsAtItsStrengthAllTheSame) {
  for (const char* strength : {"0.4 mN", "0.6 mN"}) {
    TextRun run(hanging + "strength='" + strength + "'/><Elongation limit='0.0002' interval='1'/>",
                "dt='5 ms'");
    ASSERT_TRUE(run) << run.said();
    run.run(0.2);
    EXPECT_EQ(run.number("/s", "cuts"), strength[2] == '4' ? 1 : 0) << strength;
  }
}

// Drawn by 40 mm/s on a spring of 1 N/mm, the limit bears what is above 0.94 N. At 0.9 N one beam
// tears. When the limit was asked later than the beams, two did, at up to 1.6 N.
TEST(ElongationOf, AThreadTearsOnceAndInTime) {
  for (const char* dt : {"0.5 ms", "5 ms", "20 ms"})
    for (const Real strength : {0.9, 1.0}) {
      TextRun run(
          "<SutureThread name='s' needle_length='0' tip_direction='-1 0 0' thread_length='40 mm' "
          "thread_beams='40' thread_diameter='0.2 mm' thread_young='1.5 GPa' clamp='start' "
          "strength='" +
              std::to_string(strength) +
              " N'/><Elongation limit='0.02'/>"
              "<Track name='way' times='0 0.2 s' positions='0 0 0  8 0 0 mm'/>"
              "<Grasper name='h' at='40 mm' track='way' stiffness='1000' rotation_stiffness='0'/>",
          "dt='" + std::string(dt) + "' gravity='0 0 0'");
      ASSERT_TRUE(run) << run.said();
      Real most = 0;
      while (run.simulation().time() < 0.1) {
        EXPECT_FALSE(run.simulation().step().missed()) << dt << ' ' << strength;
        most = std::max(most, run.vector("/h", "force").norm());
      }
      EXPECT_EQ(run.number("/s", "cuts"), 1) << dt << ' ' << strength;
      EXPECT_LT(most, 1.1 * strength) << dt;
    }
}

// A thread of 1 N, which is 0.85 mm longer under that, is drawn with 40 and 400 mm/s. Where a step
// cannot be made short enough to tell when it tore, the run says what it bore. Nothing was divided
// before, and a hand of 400 mm/s felt 23 N in a step of 50 ms.
TEST(AThread, TearsAtItsStrengthHoweverLongTheStepIs) {
  for (const char* dt : {"2 ms", "10 ms", "50 ms"})
    for (const std::string way : {"8 0 0 mm", "80 0 0 mm"}) {
      TextRun run(
          "<SutureThread name='s' needle_length='0' tip_direction='-1 0 0' thread_length='40 mm' "
          "thread_beams='40' thread_diameter='0.2 mm' thread_young='1.5 GPa' strength='1 N' "
          "clamp='start'/><Track name='way' times='0 0.2 s' positions='0 0 0  " +
              way + "'/><Grasper name='h' at='40 mm' track='way' rotation_stiffness='0'/>",
          "dt='" + std::string(dt) + "' gravity='0 0 0'");
      ASSERT_TRUE(run) << run.said();
      bool said = false;
      while (run.number("/s", "cuts") == 0 && run.simulation().time() < 0.19) {
        said = run.simulation().step().missed();
        EXPECT_LT(run.vector("/h", "force").norm(), 1.6) << dt << ' ' << way;
      }
      EXPECT_EQ(run.number("/s", "cuts"), 1) << dt << ' ' << way;
      // 16 parts of 50 ms are 3 ms, in which the fast hand goes by 1.2 mm.
      EXPECT_EQ(said, way == "80 0 0 mm" && dt != std::string("2 ms")) << dt << ' ' << way;
    }
}

// Two hands draw 0.4 N. The section between them bears as much, whoever bears it.
TEST(ElongationOf, AThreadHasTheTensionThatItsHandsFeel) {
  TextRun run(
      "<SutureThread name='s' needle_length='0' tip_direction='-1 0 0' thread_length='50 mm' "
      "thread_beams='10' thread_diameter='0.1 mm' thread_young='1 GPa' damping_stiffness='1 ms'/>"
      "<Elongation limit='0.002' interval='2'/><Track name='rest' times='0' positions='0 0 0'/>"
      "<Track name='way' times='0 0.2 s' positions='0 0 0  4.1 0 0 mm'/>"
      "<Grasper name='a' at='0' track='rest' stiffness='1e6' rotation_stiffness='0'/>"
      "<Grasper name='b' at='50 mm' track='way' stiffness='100' rotation_stiffness='0'/>"
      "<ThreadProbe name='middle' at='24 mm'/>",
      "dt='5 ms' gravity='0 0 0'");
  ASSERT_TRUE(run) << run.said();
  for (const Real until : {0.15, 0.4}) {  // while the hand moves, and at rest
    run.run(until);
    const Real pull = run.vector("/b", "force").norm();
    EXPECT_GT(pull, 0.2);
    // What is left of 1 % is the inertia of 0.4 mg of thread and the tolerance of a step.
    EXPECT_NEAR(run.number("/middle", "tension"), pull, 0.01 * pull) << until;
    EXPECT_NEAR(run.vector("/middle", "force").norm(), pull, 0.01 * pull) << until;
  }
}

TEST(ElongationOf, AThreadThatSettlesBeyondItIsRefused) {
  TextRun run(hanging + "settle='true'/><Elongation limit='0.001' interval='1'/>", "dt='5 ms'");
  EXPECT_FALSE(run);
  EXPECT_NE(run.said().find("beyond 'limit'"), std::string::npos) << run.said();
}

// 1 N pulls in the middle of a thread that hangs on one end only: that half is 0.1 % longer, the
// other bears nothing. Over several beams a row limits the mean: the near ones then go beyond it.
TEST(ElongationOf, AThreadIsHeldUpToALoadInItsMiddle) {
  for (const char* interval : {"", "interval='4'"}) {
    TextRun run(
        "<SutureThread name='s' needle_length='0' thread='4-0 polypropylene' thread_length='100 "
        "mm' thread_beams='20' tip_direction='-1 0 0' clamp='start' damping_stiffness='0.1 ms' "
        "damping_mass='50 1/s'/><Elongation name='limit' limit='0.001' " +
        std::string(interval) +
        "/><ThreadLoad at='50 mm' force='1 0 0 N' times='0 0.1 s' factors='0 1'/>"
        "<ThreadProbe name='middle' at='50 mm'/>");
    ASSERT_TRUE(run) << run.said();
    run.run(0.3);
    const StepReport& report = run.simulation().report();
    if (*interval != 0) {
      ASSERT_FALSE(report.faults.empty());
      EXPECT_NE(report.faults[0].find("beyond 'limit'"), std::string::npos) << report.faults[0];
      continue;
    }
    EXPECT_TRUE(report.faults.empty());
    EXPECT_NEAR(run.vector("/middle", "displacement").x(), 0.001 * 0.05, 1e-3 * 0.001 * 0.05);
    EXPECT_NEAR(run.number("/s", "largest_strain"), 0.001, 1e-6);
  }
}

struct Throw {
  Real part;        // of a step after which the hand lets go
  const char* way;  // of the hand, where it goes after that time (mm)
};
void PrintTo(const Throw& t, std::ostream* out) {
  *out << t.part << " of a step, then to " << t.way;
}
class Thrown : public ::testing::TestWithParam<Throw> {};

// A hand carries a stiff thread at 1 m/s, lets go, and stops or goes back at that moment. Nothing
// acts on the thread any more, so it flies on at 1 m/s, wherever in a step that was.
TEST_P(Thrown, AThreadKeepsTheSpeedOfTheHand) {
  for (const Real dt : {2e-3, 1e-2, 5e-2}) {
    const Real at = 0.2 + GetParam().part * dt;
    const std::string time = std::to_string(at), x = std::to_string(1e3 * at);
    TextRun run(
        "<SutureThread name='s' needle_length='0' tip_direction='-1 0 0' thread_length='20 mm' "
        "thread_beams='10' thread_diameter='0.5 mm' thread_young='3 GPa' velocity='1 0 0'/>"
        "<Track times='0 " +
            time + " 1 s' positions='0 0 0  " + x + " 0 0  " + GetParam().way +
            " mm'/><Grasper at='10 mm' release='" + time + " s'/>",
        "gravity='0 0 0' dt='" + std::to_string(1e3 * dt) + " ms'");
    ASSERT_TRUE(run) << run.said();
    run.run(0.4);
    const Vec3 speed = run.vector("/s", "momentum") / run.simulation().bodies()[0].body->mass();
    // The grip is a spring, and times and places are written with six digits.
    EXPECT_LT((speed - Vec3::UnitX()).norm(), 1e-6) << dt;
  }
}

INSTANTIATE_TEST_SUITE_P(Wherever, Thrown,
                         ::testing::Values(Throw{0.01, "-200 0 0"}, Throw{0.05, "200 0 0"},
                                           Throw{0.05, "-200 0 0"}, Throw{0.3, "-200 0 0"},
                                           Throw{0.93, "-200 0 0"}, Throw{0.95, "-200 0 0"},
                                           Throw{0.99, "-200 0 0"}));

// A moment of fixed direction has no potential, and steps that took it for one swung a thread out
// of its plane for ever. 2 EI / L bends a cantilever to an arc of 2 rad.
class EndMoment : public ::testing::TestWithParam<const char*> {};

TEST_P(EndMoment, BendsAThreadInItsPlaneAndLeavesItAtRest) {
  TextRun run(
      "<SutureThread name='s' needle_length='0' tip_direction='-1 0 0' plane_normal='0 1 0' "
      "thread_length='100 mm' thread_beams='50' thread_diameter='0.3 mm' thread_young='2 GPa' "
      "clamp='start' damping_mass='20'/>"
      "<ThreadLoad at='100 mm' moment='0 1.5904e-5 0' times='0 0.5 s' factors='0 1'/>",
      std::string("gravity='0 0 0' dt='") + GetParam() + "'");
  ASSERT_TRUE(run) << run.said();
  Index passes = 0, steps = 0;
  for (; run.simulation().time() < 3 - 1e-9; ++steps) passes += run.simulation().step().passes;
  const Vec3 end = run.vector("/s", "end_position");
  // On a circle of radius L/2: L/2 sin 2 along, L/2 (1 - cos 2) aside. The moment is rounded to
  // five digits, which shifts the end by 2e-6 m.
  EXPECT_NEAR(end.x(), 0.05 * std::sin(2), 1e-5);
  EXPECT_NEAR(std::abs(end.z()), 0.05 * (1 - std::cos(2)), 1e-5);
  EXPECT_LT(std::abs(end.y()), 1e-9);
  EXPECT_LT(run.number("/s", "kinetic_energy"), 1e-18);
  EXPECT_LT(passes, 2 * steps);  // passes contract
}

INSTANTIATE_TEST_SUITE_P(AtAnyStep, EndMoment, ::testing::Values("1 ms", "10 ms", "50 ms"));

// An arc of more than half a turn, found at once.
TEST(EndMomentOf, AThreadThatSettlesBendsItAtOnce) {
  TextRun run(
      "<SutureThread name='s' needle_length='0' tip_direction='-1 0 0' plane_normal='0 1 0' "
      "thread_length='100 mm' thread_beams='50' thread_diameter='0.3 mm' thread_young='2 GPa' "
      "clamp='start' settle='true'/><ThreadLoad at='100 mm' moment='0 3.1808e-5 0'/>",
      "gravity='0 0 0' dt='10 ms'");
  ASSERT_TRUE(run) << run.said();
  // 4 EI / L: an arc of 4 rad on a circle of radius L/4. Rounded as above.
  const Vec3 end = run.vector("/s", "end_position");
  EXPECT_NEAR(end.x(), 0.025 * std::sin(4), 1e-5);
  EXPECT_NEAR(std::abs(end.z()), 0.025 * (1 - std::cos(4)), 1e-5);
  EXPECT_LT(std::abs(end.y()), 1e-9);
}

/// What is said of a load with these keys, at 10 ms a step.
std::string said_of_load(const std::string& times, const std::string& factors) {
  TextRun run(
      "<SutureThread name='s' needle_length='0' thread_length='50 mm' thread_beams='5'/>"
      "<ThreadLoad at='25 mm' force='1 0 0 mN' factors='" +
          factors + "' times='" + times + "'/>",
      "dt='10 ms'");
  EXPECT_TRUE(run) << run.said();
  return run.said();
}

// A step looks at its end: a pulse within it is missed, or lasts for all of it.
TEST(KeysWithinAStep, AreWarnedOf) {
  EXPECT_NE(said_of_load("0.0995 0.1 0.1005 s", "0 1 0").find("three keys lie within one step"),
            std::string::npos);
  EXPECT_EQ(said_of_load("0.1 0.105 0.12 s", "0 1 0"), "");
}

// What happens before the first step ends is not seen.
TEST(KeysWithinAStep, AtTheStartAreWarnedOf) {
  EXPECT_NE(said_of_load("0 0.004 s", "1 0").find("a key lies within the first step"),
            std::string::npos);
  EXPECT_NE(said_of_load("0 0.01 s", "1 0").find("a key lies within the first step"),
            std::string::npos);
  EXPECT_EQ(said_of_load("0 0.011 s", "1 0"), "");
}

// Long beams carry momentum in their bending, which a cut must not lose.
TEST(CutInFlight, KeepsMomentum) {
  TextRun run(
      "<SutureThread name='s' needle_length='0' tip_direction='-1 0 0' thread_length='100 mm' "
      "thread_beams='4' thread_diameter='0.3 mm' velocity='0.1 0 0.1 m/s' spin='0 40 7 rad/s'/>"
      "<Scissors centre='60 0 0 mm' axis='1 0 0' size='500 500 500 mm' times='0.02 s'/>",
      "gravity='0 0 0' dt='2 ms'");
  ASSERT_TRUE(run) << run.said();
  const Vec3 before = run.vector("/s", "momentum");
  run.run(0.1);
  EXPECT_EQ(run.number("/s", "cuts"), 1);
  // Rounding of positions over the length of a step.
  EXPECT_LT((run.vector("/s", "momentum") - before).norm(), 1e-10 * before.norm());
}

struct Curled {
  const char *thread, *settings;
  int beams;  // as many as its curl asks for: length times curvature over the angle
};
void PrintTo(const Curled& c, std::ostream* out) {
  *out << c.thread << c.settings;
}
class SampledCurl : public ::testing::TestWithParam<Curled> {};

// A thread that is curled at rest, at 150 1/m, flies and curls up. Nothing drives it, so it never
// has more energy than at first, however its beams are split and merged.
TEST_P(SampledCurl, GainsNoEnergyInFlight) {
  TextRun run(std::string("<SutureThread name='t' needle_length='0' tip_direction='-1 0 0' "
                          "bending_factor='0.05' thread_rest_curvature='150' "
                          "sampling_angle='0.15' ") +
                  GetParam().thread + "/>",
              std::string("gravity='0 0 0' ") + GetParam().settings);
  ASSERT_TRUE(run) << run.said();
  EXPECT_GE(run.number("/t", "beams"), GetParam().beams);
  const auto energy = [&run] {
    return run.number("/t", "elastic_energy") + run.number("/t", "kinetic_energy");
  };
  const Real first = energy();
  for (int n = 0; n < 80; ++n) {
    EXPECT_TRUE(run.simulation().step().solved) << n;
    // One event may change the bending energy by 1 % (docs/theory/thread.md).
    EXPECT_LT(energy(), 1.01 * first) << n;
    // The fastest spin, 433 rad/s, draws with density (spin length)^2 / 8: a strain of 3e-4.
    EXPECT_LT(run.number("/t", "largest_strain"), 3e-4) << n;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Threads, SampledCurl,
    ::testing::Values(
        Curled{"thread_length='60 mm' thread_beams='12' thread_diameter='0.2 mm' "
               "thread_young='100 MPa' spin='31.472 -3.388 1.739'",
               "dt='1 ms'", 60},
        Curled{"thread_length='150 mm' thread_beams='20' thread_diameter='0.2 mm' "
               "thread_young='10 MPa' thread_direction='0 1 0' thread_bend_radius='6 mm' "
               "spin='1.949 -3.666 8.999'",
               "dt='2 ms' time_order='2'", 150},
        Curled{"thread_length='150 mm' thread_beams='20' thread_diameter='0.1 mm' "
               "thread_young='2 GPa' spin='419.652 -33.733 79.285'",
               "dt='7 ms' time_order='2'", 150}));

struct Column {
  Real dt;  // s
  int beams;
};
void PrintTo(const Column& c, std::ostream* out) {
  *out << c.dt << " s, " << c.beams << " beams";
}
class ColumnPushed : public ::testing::TestWithParam<Column> {};

// A straight thread along an axis, pushed together at 6 mm/s. Its compression would be hundreds of
// times what buckles it after one step. The end of a step is a minimum of the potential only while
// no wave can grow: until then bending and inertia hold 2 sqrt(EI m) / dt in an endless thread (m
// per length), and bending alone Euler's load in this one, clamped by the hand at its other end.
TEST_P(ColumnPushed, BucklesInTheStepThatPushesIt) {
  const auto [dt, beams] = GetParam();
  TextRun run(
      "<SutureThread name='t' needle_length='0' tip_direction='-1 0 0' thread_length='30 mm' "
      "thread_diameter='0.02 mm' thread_young='2 GPa' bending_factor='1' clamp='start' "
      "thread_beams='" +
          std::to_string(beams) +
          "'/><Track times='0 .023 .523 s' positions='0 0 0 0 0 0 -0.003 0 0'/>"
          "<Grasper name='h' at='30 mm'/>",
      "gravity='0 0 0' dt='" + std::to_string(dt) + "'");
  ASSERT_TRUE(run) << run.said();
  const Real radius = 1e-5, length = 30e-3, area = std::numbers::pi * radius * radius;
  const Real bending = 2e9 * area * radius * radius / 4;
  const Real euler = 4 * std::pow(std::numbers::pi / length, 2) * bending;
  const Real most = euler + 2 * std::sqrt(bending * 910 * area) / dt;
  while (run.simulation().time() < 0.15) {
    const StepReport& report = run.simulation().step();
    EXPECT_TRUE(report.solved) << run.simulation().time();
    EXPECT_TRUE(report.messages.empty()) << report.messages.front();
    EXPECT_LT(run.vector("/h", "force").norm(), most) << run.simulation().time();
  }
}

INSTANTIATE_TEST_SUITE_P(AtAnyStepAndAnyBeams, ColumnPushed,
                         ::testing::Values(Column{0.25e-3, 40}, Column{1e-3, 40},
                                           Column{2.99e-3, 40}, Column{3e-3, 38}, Column{3e-3, 39},
                                           Column{3e-3, 40}, Column{3e-3, 41}, Column{3e-3, 160},
                                           Column{3.01e-3, 40}, Column{7e-3, 20},
                                           Column{20e-3, 80}));

// 0.3 N draw at the end of a thread at its limit, then 20 mN at its middle, across. Its lower half
// turns to that: the force of the limit has to turn with it, also in the matrix of the step.
TEST(ElongationOf, ATautThreadTurnsWithIt) {
  TextRun run(
      "<SutureThread name='a' needle_length='0' thread_young='1 GPa' thread_diameter='0.2 mm' "
      "thread_length='40 mm' thread_beams='80' tip_direction='-1 0 0' plane_normal='0 0 1' "
      "damping_mass='100'/><Elongation limit='1e-3'/><Track name='still' times='0'/>"
      "<Grasper name='hand' at='0' track='still' rotation_stiffness='0'/>"
      "<ThreadLoad name='along' at='40 mm' force='0.3 0 0' times='0 50 ms' factors='0 1'/>"
      "<ThreadLoad name='aside' at='20 mm' force='0 0.02 0' times='0.1 0.2 s' factors='0 1'/>",
      "dt='5 ms' gravity='0 0 0'");
  ASSERT_TRUE(run) << run.said();
  Index most = 0;
  for (int i = 0; i < 100; ++i) most = std::max(most, run.simulation().step().passes);
  EXPECT_LE(most, 3);
  EXPECT_EQ(run.simulation().report().missed_steps, 0);
  EXPECT_LT((run.vector("/hand", "force") - Vec3(-0.3, -0.02, 0)).norm(), 1e-6);
  // Statics: the half before the middle bears (0.3, 0.02) N; where the two meet the thread's own
  // stiffness rounds the corner by sqrt(EI / T) = 0.5 mm, of which its angle takes little.
  const Real half = 20e-3 * (1 + 1e-3), angle = std::atan(0.02 / 0.3);
  EXPECT_NEAR(run.vector("/a", "end_position").y(), half * std::sin(angle), 2e-5);
}

}  // namespace
}  // namespace sutura::testing
