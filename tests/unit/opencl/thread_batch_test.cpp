// Many threads as a component: in a run of a scene, and in the hands of a host.
#include "opencl_device.h"
#include "scenes/text_run.h"
#include "some_device.h"
#include "sutura/batch.h"

namespace sutura::opencl {
namespace {

using sutura::testing::TextRun;

constexpr const char* scene = "components/ThreadBatch.xml";

class DeviceBatch : public OnDevice {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    if (device_ && !device_->has_double()) GTEST_SKIP() << "no double precision";
  }
};

std::vector<Real> observe(Batch& batch) {
  std::vector<Real> out(static_cast<std::size_t>(batch.environments() * batch.observations()));
  batch.observe(out);
  return out;
}

Batch& batch_of(TextRun& run) {
  return *dynamic_cast<Batch*>(run.simulation().find("/batch"));
}

// Sixteen points of 10 mN, none of which the thread leaves.
TEST_F(DeviceBatch, ASceneRunsAndReadsItsForce) {
  TextRun run = TextRun::file(scene, {{".gravity", "0 0 0"}});
  run.run(0.5);
  EXPECT_NEAR(std::get<Vec3>(run.output("/batch", "force")).x(), 0.16, 1e-5);
  EXPECT_LT(run.number("/batch", "residual"), 1e-9);
}

TEST_F(DeviceBatch, AHostStepsAsTheSceneDoes) {
  TextRun run = TextRun::file(scene), host = TextRun::file(scene);
  Batch& batch = batch_of(host);
  ASSERT_EQ(batch.environments(), 8);
  ASSERT_EQ(batch.actions(), 3);
  std::vector<Real> actions;
  for (int e = 0; e < 8; ++e)
    for (const Real v : {0.02, 0., 0.}) actions.push_back(v);
  for (int i = 0; i < 20; ++i) {
    run.simulation().step();
    batch.step(actions);
  }
  EXPECT_TRUE(observe(batch) == observe(batch_of(run)));
  batch.reset({});
  TextRun fresh = TextRun::file(scene);
  EXPECT_TRUE(observe(batch) == observe(batch_of(fresh)));
}

TEST_F(DeviceBatch, IsRestoredToTheBit) {
  TextRun run = TextRun::file(scene), other = TextRun::file(scene);
  for (int i = 0; i < 10; ++i) run.simulation().step();
  ASSERT_EQ(other.simulation().restore(run.simulation().save()), "");
  EXPECT_TRUE(observe(batch_of(run)) == observe(batch_of(other)));
  for (int i = 0; i < 10; ++i) {
    run.simulation().step();
    other.simulation().step();
  }
  EXPECT_TRUE(observe(batch_of(run)) == observe(batch_of(other)));
}

TEST_F(DeviceBatch, ALostDeviceEndsTheRun) {
  TextRun run = TextRun::file(scene);
  run.component<OpenClDevice>("/gpu").opened()->lose();
  const StepReport& report = run.simulation().step();
  ASSERT_TRUE(report.failure);
  EXPECT_NE(report.failure->text().find("not available"), std::string::npos)
      << report.failure->text();
}

TEST_F(DeviceBatch, SaysWhatIsWrongInTheScene) {
  const auto said = [](const std::string& device, const std::string& attributes) {
    TextRun run("<plugin name=\"opencl\"/><OpenClDevice " + device + "/>\n<ThreadBatch " +
                attributes + "/>");
    EXPECT_FALSE(run);
    return run.said();
  };
  EXPECT_NE(said("", "path=\"1 2 3 4 mm\"").find("'path' has 4 numbers"), std::string::npos);
  EXPECT_NE(said("", "path=\"1 2 3 mm\" direction=\"0 0 0\"").find("'direction' is zero"),
            std::string::npos);
  EXPECT_NE(said("device=\"no such device\" on_failure=\"cpu\"", "path=\"1 2 3 mm\"")
                .find("no CPU that takes over"),
            std::string::npos);
}

}  // namespace
}  // namespace sutura::opencl
