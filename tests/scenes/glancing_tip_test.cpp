// A straight needle that meets the skin from inside at a small angle. The skin holds its tip along
// the normal only; along the skin the tip goes on through tissue that no channel leads through yet,
// so it cuts there as it did before.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>
#include <sstream>
#include <string>

#include "text_run.h"

namespace sutura::testing {
namespace {

constexpr Real mu = 0.2, spacing = 1e-3;

struct Case {
  Real degrees, depth;  // of the needle over the skin; below it, where it enters at the side (mm)
  Real cutting, exit;   // N
  Real young;           // kPa
  Real dt;              // ms
  Vec3 axis() const {
    const Real angle = degrees * std::numbers::pi / 180;
    return {std::cos(angle), 0, std::sin(angle)};
  }
  friend void PrintTo(const Case& c, std::ostream* out) {
    *out << c.degrees << " degrees, " << c.cutting << " N, " << c.young << " kPa, " << c.dt
         << " ms";
  }
};

/// 16 mm along its axis in 1.5 s, through the side of a block whose skin is at z = 0.
TextRun driven(const Case& c) {
  const Vec3 tip = Vec3(-10, 0.3, -c.depth) - c.axis(), way = 16 * c.axis();
  std::ostringstream xml, settings;
  xml << "<BlockMesh box='-10 -8 -8 10 8 0 mm' cells='10 8 6'/><Tissue young='" << c.young
      << " kPa' poisson='0.4' element='t4' damping_stiffness='2 ms'/>"
      << "<Attach box='-10 -8 -8 10 8 -8 mm'/>"
      << "<SutureThread name='suture' needle_length='30 mm' needle_angle='0' "
         "needle_diameter='0.5 mm' plane_normal='0 1 0' thread_length='20 mm' thread_beams='10' "
      << "tip='" << tip.transpose() << " mm' tip_direction='" << c.axis().transpose()
      << "'/><Track times='0 1.5 s' positions='0 0 0 " << way.transpose()
      << " mm'/><Grasper at='28 mm'/><SuturePath spacing='1 mm'/><Puncture threshold='0.1 N' "
      << "exit_threshold='" << c.exit << " N' friction='0.2'/><Cutting threshold='" << c.cutting
      << " N'/><PathFriction coefficient='0.2' pressure='5 kPa'/>";
  settings << "gravity='0 0 0' dt='" << c.dt << " ms'";
  return TextRun(xml.str(), settings.str());
}

bool tents(const TextRun& run) {
  return std::get<std::string>(run.output("/puncture", "state")) == "tenting";
}

class GlancingTip : public ::testing::TestWithParam<Case> {};
class GlancingTent : public GlancingTip {};

TEST_P(GlancingTent, CutsOnAlongTheSkin) {
  const Case& c = GetParam();
  const Real sine = c.axis().z();
  TextRun run = driven(c);
  ASSERT_TRUE(run) << run.said();
  Real met_at = INFINITY, tip = 0;
  while (run.simulation().time() < 1.5 - 1e-9) {
    const StepReport& report = run.simulation().step();
    ASSERT_TRUE(report.solved) << report.step;
    ASSERT_TRUE(report.faults.empty()) << report.faults.front();
    tip = run.vector("/suture", "tip_position").x();
    if (!tents(run)) continue;
    met_at = std::min(met_at, tip);
    // What held the tip along its axis has to be taken over, by tissue that gives some way for it.
    if (tip < met_at + spacing) continue;
    EXPECT_NEAR(run.number("/cutting", "force"), c.cutting, 1e-9) << "at " << tip;
    // The hand bears what the tip meets along the skin, cutting and friction; what rubs on the
    // shaft; and of the normal force the sine of the angle between needle and skin. That is the
    // one at which the needle was set, or less where it has bent; the forces of the channel across
    // it have no part along it. A hundredth is the tolerance of a step.
    const Real normal = run.number("/puncture", "force");
    const Real hand = run.vector("/grasper", "force").dot(c.axis());
    const Real along = c.cutting + mu * normal + run.number("/path_friction", "force");
    EXPECT_GE(hand, along - 0.01 * hand) << "at " << tip;
    EXPECT_LE(hand, along + normal * sine + 0.01 * hand) << "at " << tip;
  }
  EXPECT_GT(tip, met_at + 5 * spacing) << "it has not glided far";
  // One sample at the mouth and one each millimetre of channel. Tissue that is pressed along the
  // needle makes it shorter by less than the millimetre that the last sample may be away.
  const Real inside = run.number("/suture_path", "inserted_length");
  EXPECT_NEAR(run.number("/suture_path", "samples"), inside / spacing + 0.5, 1);
  EXPECT_EQ(run.number("/puncture", "punctures"), 1);
  EXPECT_EQ(run.number("/puncture", "overruns"), 0);
}

INSTANTIATE_TEST_SUITE_P(AnglesAndSteps, GlancingTent,
                         ::testing::Values(Case{7, 1, 0.3, 1, 100, 10}, Case{7, 1, 0.1, 1, 100, 20},
                                           Case{7, 1, 0.1, 1, 100, 2.5}, Case{7, 1, 0.1, 1, 30, 10},
                                           Case{4, 0.6, 0.1, 1, 100, 10},
                                           Case{12, 1.5, 0.1, 1, 300, 10}));

/// Through the skin there is nothing to cut, in the step of the puncture already.
TEST_P(GlancingTip, CutsUntilItIsThrough) {
  TextRun run = driven(GetParam());
  ASSERT_TRUE(run) << run.said();
  int tenting = 0;
  Real samples = 0;
  while (run.simulation().time() < 1.5 - 1e-9) {
    const StepReport& report = run.simulation().step();
    ASSERT_TRUE(report.solved) << report.step;
    ASSERT_TRUE(report.faults.empty()) << report.faults.front();
    tenting += tents(run);
    if (run.number("/puncture", "punctures") < 2) {
      samples = run.number("/suture_path", "samples");
      continue;
    }
    EXPECT_EQ(run.number("/cutting", "force"), 0) << report.step;
    // The mouth, which may take the place of the last sample before it.
    EXPECT_LE(run.number("/suture_path", "samples"), samples + 1) << report.step;
  }
  EXPECT_GE(tenting, 2);
  EXPECT_EQ(run.number("/puncture", "punctures"), 2);
  EXPECT_EQ(run.number("/puncture", "overruns"), 0);
  EXPECT_EQ(std::get<std::string>(run.output("/suture_path", "state")), "outside");
}

INSTANTIATE_TEST_SUITE_P(AnglesAndSteps, GlancingTip,
                         ::testing::Values(Case{7, 1, 0.1, 0.15, 100, 10},
                                           Case{20, 3, 0.1, 0.4, 100, 10},
                                           Case{30, 4, 0.1, 0.5, 100, 20},
                                           Case{45, 5, 0.1, 0.3, 100, 5},
                                           Case{60, 5, 0.1, 0.3, 100, 10}));

}  // namespace
}  // namespace sutura::testing
