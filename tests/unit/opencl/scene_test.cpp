// A scene says which device its solvers use, and nothing else of it changes.
#include "opencl_device.h"
#include "scenes/text_run.h"
#include "some_device.h"

namespace sutura::opencl {
namespace {

using Overrides = std::vector<std::pair<std::string, std::string>>;
using sutura::testing::TextRun;

constexpr const char* scene = "components/OpenClDevice.xml";

/// Six passes a step, whatever is reached before, and nothing is solved roughly: where iterations
/// stop early is what CPU and device may differ by.
Overrides six_passes(const std::string& tolerance, Overrides more) {
  for (const auto& [name, value] : Overrides{{"/block/async_preconditioner.tolerance", tolerance},
                                             {".tolerance", "1e-9"},
                                             {".gap_tolerance", "1 nm"},
                                             {".passes", "6"},
                                             {".substeps", "1"}})
    more.push_back({name, value});
  return more;
}

class DeviceScene : public OnDevice {};

struct InPrecision {
  const char* precision;
  const char* solved_to;  ///< what conjugate gradients reach in it
  Real off;               ///< by which forces may be off, of the largest: what was asked for
};
class DevicePrecision : public OnDevice, public ::testing::WithParamInterface<InPrecision> {};

// The needle pierces the block in these 0.3 s: contact, puncture, path and friction.
TEST_P(DevicePrecision, ForcesAreThoseOfTheCpu) {
  const auto [precision, solved_to, off] = GetParam();
  if (!device_->has_double() && std::string(precision) != "single")
    GTEST_SKIP() << "no double precision";
  TextRun there = TextRun::file(
      scene, six_passes(solved_to, {{"/gpu.on_failure", "stop"}, {"/gpu.precision", precision}}));
  TextRun cpu = TextRun::file(scene, six_passes("1e-9", {{"/gpu.device", "no such device"}}));
  EXPECT_NE(cpu.said().find("there is \""), std::string::npos) << "the warning: " << cpu.said();
  EXPECT_EQ(std::get<std::string>(cpu.output("/gpu", "used")), "");
  EXPECT_EQ(std::get<std::string>(there.output("/gpu", "used")), device_->name());
  Real largest = 0;
  for (int step = 0; step < 30; ++step) {
    const StepReport& report = there.simulation().step();
    ASSERT_FALSE(report.failure) << report.failure->text();
    EXPECT_TRUE(report.messages.empty()) << report.messages.front();
    cpu.simulation().step();
    const Real ours = cpu.number("/puncture", "force"), theirs = there.number("/puncture", "force");
    largest = std::max(largest, ours);
    EXPECT_NEAR(theirs, ours, off * largest) << "step " << step;
    EXPECT_EQ(there.number("/puncture", "punctures"), cpu.number("/puncture", "punctures"));
  }
  EXPECT_GT(largest, 0.4) << "there is something to compare";
}

INSTANTIATE_TEST_SUITE_P(Precisions, DevicePrecision,
                         ::testing::Values(InPrecision{"double", "1e-9", 1e-6},
                                           InPrecision{"mixed", "1e-6", 1e-6},
                                           InPrecision{"single", "1e-5", 1e-4}),
                         [](const auto& info) { return info.param.precision; });

// The matrix that a saved state brings along goes back to where it was made.
TEST_F(DeviceScene, ARestoredRunRepeatsTheBits) {
  TextRun run = TextRun::file(scene, {{"/gpu.on_failure", "stop"}}),
          other = TextRun::file(scene, {{"/gpu.on_failure", "stop"}});
  for (int i = 0; i < 15; ++i) run.simulation().step();
  ASSERT_EQ(other.simulation().restore(run.simulation().save()), "");
  for (int i = 0; i < 6; ++i) {
    run.simulation().step();
    other.simulation().step();
    EXPECT_EQ(run.number("/block/tissue", "energy"), other.number("/block/tissue", "energy")) << i;
  }
  EXPECT_GT(run.number("/block/tissue", "energy"), 0);
}

TEST_F(DeviceScene, ALostDeviceIsSaidAndTheStepIsSolved) {
  TextRun run = TextRun::file(scene);
  for (int i = 0; i < 30; ++i) run.simulation().step();
  run.component<OpenClDevice>("/gpu").opened()->lose();
  const StepReport& report = run.simulation().step();
  EXPECT_TRUE(report.solved);
  EXPECT_FALSE(report.failure);
  ASSERT_FALSE(report.messages.empty());
  EXPECT_NE(report.messages[0].find("the CPU has taken over"), std::string::npos)
      << report.messages[0];
  EXPECT_EQ(std::get<std::string>(run.output("/gpu", "used")), "");
}

TEST_F(DeviceScene, ALostDeviceStopsARunThatAsksForIt) {
  TextRun run = TextRun::file(scene, {{"/gpu.on_failure", "stop"}});
  run.simulation().step();
  run.component<OpenClDevice>("/gpu").opened()->lose();
  const StepReport& report = run.simulation().step();
  ASSERT_TRUE(report.failure);
  EXPECT_EQ(report.failure->category, Category::plugin);
  EXPECT_NE(report.failure->message.find("the device is not available"), std::string::npos)
      << report.failure->message;
}

TEST(DeviceSceneErrors, NameTheAttribute) {
  const auto said = [](const std::string& content) {
    TextRun run("<plugin name=\"opencl\"/>" + content);
    EXPECT_FALSE(run);
    return run.said();
  };
  EXPECT_NE(said("<OpenClDevice device=\"no such device\"/>").find("on_failure=\"cpu\""),
            std::string::npos);
  EXPECT_NE(said("<OpenClDevice name=\"g\" on_failure=\"cpu\"/>"
                 "<GaussSeidel device=\"g\" acceleration=\"nncg\"/>")
                .find("nncg"),
            std::string::npos);
  EXPECT_NE(said("<OpenClDevice name=\"g\" on_failure=\"cpu\"/>"
                 "<BlockMesh box=\"0 0 0  30 20 10 mm\" cells=\"3 3 2\"/><Tissue/>"
                 "<AsyncPreconditioner device=\"g\" backend=\"eigen\"/>")
                .find("supernodes"),
            std::string::npos);
  const std::string tissue =
      "<BlockMesh box=\"0 0 0  30 20 10 mm\" cells=\"3 3 2\"/><Tissue/>"
      "<AsyncPreconditioner device=\"/g\"/></node>";
  EXPECT_NE(said("<OpenClDevice name=\"g\" on_failure=\"cpu\"/><node name=\"a\">" + tissue +
                 "<node name=\"b\">" + tissue)
                .find("of its own"),
            std::string::npos);
}

}  // namespace
}  // namespace sutura::opencl
