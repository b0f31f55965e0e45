// The first stitch with the thread's compliance as an operator, and in W: the same run.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "csv.h"
#include "house/command.h"

namespace sutura::testing {
namespace {

using house::TemporaryFolder;

struct FormRun {
  Table table;
  std::string text;
};

/// Until the needle is through the skin and half way along its channel.
FormRun run_with(const std::string& form) {
  const TemporaryFolder folder("mixed_compliance_" + form);
  std::ifstream in(SUTURA_SOURCE_DIR "/scenes/suture/first_stitch.xml");
  std::stringstream text;
  text << in.rdbuf();
  std::string scene = text.str();
  scene.replace(scene.find("<SuturePath"), 0,
                "<GaussSeidel name=\"solver\" compliance=\"" + form + "\"/>\n  ");
  scene.replace(scene.find("../meshes"), 9, SUTURA_SOURCE_DIR "/scenes/meshes");
  const std::filesystem::path file = folder.path() / "scene.xml";
  std::ofstream(file) << scene;
  const house::Outcome outcome = house::command(
      "run " + file.string() + " --steps 130 --set /vtu_recorder.interval=1 --output " +
      folder.path().string());
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  return {read_csv((folder.path() / "stitch.csv").string()), outcome.text};
}

TEST(MixedCompliance, AStitchDoesNotDependOnTheForm) {
  const FormRun assembled = run_with("assembled"), mixed = run_with("operator");
  ASSERT_EQ(assembled.table.rows.size(), 131u);
  ASSERT_EQ(mixed.table.rows.size(), 131u);
  EXPECT_NE(assembled.text.find("compliance of /suture: operator in 0 of"), std::string::npos)
      << assembled.text;
  EXPECT_NE(mixed.text.find("compliance of /suture: operator in"), std::string::npos) << mixed.text;
  EXPECT_EQ(mixed.text.find("compliance of /suture: operator in 0 of"), std::string::npos)
      << mixed.text;

  const std::vector<std::string> forces = {"puncture.force [N]",        "cutting.force [N]",
                                           "friction.force [N]",        "path.lateral_force [N]",
                                           "tools/holder.force.x [N]",  "tools/holder.force.z [N]",
                                           "skin/tissue.reaction.z [N]"};
  const std::vector<std::string> lengths = {
      "path.inserted_length [m]", "path.tip_depth [m]", "suture.tip_position.x [m]",
      "suture.tip_position.z [m]", "skin/tissue.max_displacement [m]"};
  std::size_t contact = 0, pierced = 0;
  for (std::size_t i = 0; i < assembled.table.rows.size(); ++i) {
    const auto at = [&](const FormRun& r, const std::string& column) {
      return r.table.number(i, column);
    };
    if (contact == 0 && at(assembled, "puncture.force [N]") > 0) {
      // The first step with rows starts from the same bits: only the solve differs, in its
      // rounding. The system of a step is conditioned like 1e7 at worst.
      contact = i;
      EXPECT_NEAR(at(mixed, "puncture.force [N]"), at(assembled, "puncture.force [N]"),
                  1e-9 * at(assembled, "puncture.force [N]"));
    }
    if (pierced == 0 && at(assembled, "puncture.punctures") > 0) pierced = i;
    EXPECT_EQ(at(mixed, "puncture.punctures"), at(assembled, "puncture.punctures")) << i;
    // Steps inherit and may enlarge what the one before left, and where the passes stop is decided
    // by rounding. The trajectory keeps together.
    for (const std::string& f : forces)
      EXPECT_NEAR(at(mixed, f), at(assembled, f), 1e-6) << f << " " << i;
    for (const std::string& l : lengths)
      EXPECT_NEAR(at(mixed, l), at(assembled, l), 5e-9) << l << " " << i;
  }
  EXPECT_GT(contact, 20u);
  EXPECT_GT(pierced, contact);
  EXPECT_LT(pierced, 80u);  // fifty steps and more with a channel
}

}  // namespace
}  // namespace sutura::testing
