// The wound of the docs (docs/wound.md) from the first bite to the last pull: two lips that stand
// apart, each pierced from outside and from inside, twice.
#include <gtest/gtest.h>

#include <string>

#include "csv.h"
#include "house/command.h"

namespace sutura::testing {
namespace {

// At the end of the last pull the thread slides round eight mouths. In one draw of two some steps
// there missed their tolerance with beams of 0.5 mm, in none with the 0.4 mm that it has
// (docs/validation/step.md); a few may, if they say so, and nothing else.
TEST(Wound, IsSewnWithTwoBites) {
  const house::TemporaryFolder folder("wound");
  const house::Outcome outcome =
      house::command("run " SUTURA_SOURCE_DIR
                     "/scenes/suture/wound.xml --set /vtu_recorder.interval=1e9 --output " +
                     folder.path().string());
  EXPECT_EQ(outcome.text.find("FAULT"), std::string::npos) << outcome.text;
  if (outcome.code != 0) {
    EXPECT_EQ(outcome.code, 5) << outcome.text;
    const std::string missed = "TOLERANCE MISSED in ", first = "first in step ";
    ASSERT_NE(outcome.text.find(missed), std::string::npos) << outcome.text;
    EXPECT_LT(std::stoi(outcome.text.substr(outcome.text.find(missed) + missed.size())), 5);
    EXPECT_GT(std::stoi(outcome.text.substr(outcome.text.find(first) + first.size())), 700);
  }
  const Table t = read_csv((folder.path() / "probe.csv").string());
  const std::size_t last = t.rows.size() - 1;
  EXPECT_EQ(t.number(last, "puncture.punctures"), 8);
  EXPECT_EQ(t.text(last, "suture_path.state"), "outside");
  // Each bite goes 5 to 6 mm through the left lip and as far through the right one, less than half
  // a turn of the needle (17 mm, 3/8): four times that is inside at the end.
  EXPECT_GT(t.number(last, "suture_path.inserted_length [m]"), 14e-3);
  EXPECT_LT(t.number(last, "suture_path.inserted_length [m]"), 24e-3);
}

}  // namespace
}  // namespace sutura::testing
