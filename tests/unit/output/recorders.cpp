// VtuRecorder, CsvProbe and ConstraintTable in a scene with a rod and a source of two known blocks.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "constraint_table.h"
#include "csv_probe.h"
#include "unit/output/vtu_reader.h"
#include "unit/tools/fake_curve.h"
#include "vtu_recorder.h"

namespace sutura::output {
namespace {

struct Pull {  // lambda is whatever its parameter says: a law that needs no solver to be right
  static constexpr int dim = 1;
  static constexpr const char* name = "pull";
  struct Params {
    Real force;
  };
  static void project(const BlockMatrix<1>&, const BlockVector<1>&, const Params& p, Mode& mode,
                      BlockVector<1>& lambda) {
    lambda[0] = p.force;
    mode = 3;
  }
  static void free_directions(const BlockVector<1>&, const Params&, Mode, const BlockVector<1>&,
                              FreeDirections<1>& free) {
    free.count = 0;
  }
};

/// Pulls the tip of a curve along z with 0.5 N from its second step on.
class Puller : public Component, public ConstraintSource {
 public:
  static void describe(Describe<Puller>& d) {
    d.summary("Pulls.");
    d.link("body", &Puller::body_, "What it pulls.");
  }
  void initialise(Setup& setup) override { id_ = setup.source_id; }
  void build(const StepContext& context, ConstraintBuilder& builder) override {
    if (context.step == 0) return;
    const BlockId block =
        builder.add<Pull>(make_key(id_, 0), {0.5}, BlockVector<1>(BlockVector<1>::Zero()));
    PointJacobian J;
    J.nodes = 1;
    J.width = 6;
    J.coefficients = Eigen::Matrix<Real, 3, 6>::Identity();
    Eigen::Matrix<Real, Eigen::Dynamic, 3> up(1, 3);
    up << 0, 0, 1;
    builder.couple(block, *body_, up, J, body_->point(0, Configuration::current));
  }

 private:
  Link<CurveBody> body_;
  Index id_ = 0;
};

/// A pole as high as the number of the step (m), down again in step 3.
class Flag : public Component, public Driver, public Drawing {
 public:
  static void describe(Describe<Flag>& d) { d.summary("Draws itself."); }
  void drive(const StepContext& context) override { height_ = static_cast<Real>(context.step + 1); }
  BodyGeometry geometry() const override {
    BodyGeometry line;
    if (height_ == 3) return line;
    line.points = {Vec3::Zero(), Vec3(0, 0, height_)};
    line.connectivity = {0, 1};
    return line;
  }

 private:
  Real height_ = 0;
};

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

class Recorders : public testing::Test {
 protected:
  Recorders() {
    registry_.component<VtuRecorder>("VtuRecorder");
    registry_.component<CsvProbe>("CsvProbe");
    registry_.component<ConstraintTable>("ConstraintTable");
    registry_.component<fake::Curve>("Curve");
    registry_.component<Puller>("Puller");
    registry_.component<Flag>("Flag");
    registry_.law<Pull>();
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) / (std::string("sutura_") + test->name());
    std::filesystem::remove_all(folder_);
  }
  /// Runs the scene; the error sentence of the recorders, or empty.
  std::string run(const std::string& elements, int steps) {
    Diagnostics diagnostics;
    auto scene = load_scene_text("<sutura version=\"1\" dt=\"0.01 s\">" + elements + "</sutura>",
                                 "test.xml", ".", registry_, diagnostics);
    simulation_.reset();  // one run owns the folder
    if (scene) simulation_ = Simulation::compile(std::move(scene), folder_, diagnostics);
    if (!diagnostics.ok()) return diagnostics.all().front().text();
    if (std::string error = simulation_->start_recording(); !error.empty()) return error;
    for (int i = 0; i < steps; ++i) simulation_->step();
    return simulation_->finish_recording();
  }
  Registry registry_;
  std::filesystem::path folder_;
  std::unique_ptr<Simulation> simulation_;
};

TEST_F(Recorders, ProbeWritesOneRowPerStepWithUnits) {
  ASSERT_EQ(run("<Curve name='rod' origin='1 2 3 mm'/>"
                "<CsvProbe columns='/rod.tip /rod.held' report='true'/>",
                2),
            "");
  EXPECT_EQ(contents(folder_ / "probe.csv"),
            "step,time [s],rod.tip.x [m],rod.tip.y [m],rod.tip.z [m],rod.held,"
            "rows,sweeps,residual,violation [m],passes,parts,imbalance,time_error [m],solved\n"
            "0,0,0.001,0.002,0.003,no,0,0,0,0,0,1,0,0,1\n"
            "1,0.01,0.001,0.002,0.003,no,0,0,0,0,1,1,0,0,1\n"
            "2,0.02,0.001,0.002,0.003,no,0,0,0,0,1,1,0,0,1\n");
}

TEST_F(Recorders, ProbeIsCompleteBeforeItIsFinished) {
  Diagnostics diagnostics;
  auto scene = load_scene_text(
      "<sutura version=\"1\" dt=\"0.01 s\"><Curve name='rod'/><CsvProbe "
      "columns='/rod.held'/></sutura>",
      "test.xml", ".", registry_, diagnostics);
  ASSERT_TRUE(scene);
  auto simulation = Simulation::compile(std::move(scene), folder_, diagnostics);
  ASSERT_TRUE(simulation);
  ASSERT_EQ(simulation->start_recording(), "");
  simulation->step();
  EXPECT_EQ(contents(folder_ / "probe.csv"), "step,time [s],rod.held\n0,0,no\n1,0.01,no\n");
}

TEST_F(Recorders, ProbeQuotesText) {
  EXPECT_EQ(csv_field("plain"), "plain");
  EXPECT_EQ(csv_field("yes, held"), "\"yes, held\"");
  EXPECT_EQ(csv_field("a \"b\"\n"), "\"a \"\"b\"\"\n\"");
}

TEST_F(Recorders, ProbeErrorsNameTheNearest) {
  const std::string rod = "<Curve name='rod'/>";
  const auto error = [&](const std::string& columns) {
    return run(rod + "<CsvProbe columns='" + columns + "'/>", 0);
  };
  EXPECT_NE(error("/rot.tip").find("did you mean '/rod'"), std::string::npos) << error("/rot.tip");
  EXPECT_NE(error("/rod.tipp").find("did you mean 'tip'"), std::string::npos);
  EXPECT_NE(error("/rod.velocity").find("it has tip, held"), std::string::npos);
  EXPECT_NE(error("rod").find("as in /holder.force"), std::string::npos);
  EXPECT_NE(error("/rod.").find("as in /holder.force"), std::string::npos);
  EXPECT_NE(
      run(rod + "<CsvProbe name='a' columns='/rod.tip'/><CsvProbe name='b' columns='/rod.held'/>",
          0)
          .find("overwrite"),
      std::string::npos);
  EXPECT_EQ(run(rod + "<CsvProbe name='a' columns='/rod.tip'/><CsvProbe name='b' "
                      "columns='/rod.held' file='b.csv'/>",
                0),
            "");
}

TEST_F(Recorders, TableHoldsARowPerConstraint) {
  const std::string scene =
      "<Curve name='rod' origin='1 2 3 mm'/><Puller name='a'/><Puller name='b'/>";
  ASSERT_EQ(run(scene + "<ConstraintTable every='2'/>", 3), "");
  EXPECT_EQ(contents(folder_ / "constraints.csv"),
            "step,time [s],source,id,law,state,at.x [m],at.y [m],at.z [m],force.x [N],force.y "
            "[N],force.z [N],violation [m]\n"
            "2,0.02,/a,0,pull,3,0.001,0.002,0.003,0,0,0.5,0\n"
            "2,0.02,/b,0,pull,3,0.001,0.002,0.003,0,0,0.5,0\n");
  const std::string twice =
      run(scene + "<ConstraintTable name='x'/><ConstraintTable name='y'/>", 0);
  EXPECT_NE(twice.find("overwrite"), std::string::npos) << twice;
}

TEST_F(Recorders, VtuHoldsBodiesAndConstraintForces) {
  ASSERT_EQ(run("<Curve name='rod' origin='1 2 3 mm'/><Puller/><VtuRecorder/>", 2), "");
  for (const char* file :
       {"rod.pvd", "constraints.pvd", "rod/rod_000000.vtu", "constraints/constraints_000002.vtu"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_ / file)) << file;
  }
  const std::string pvd = contents(folder_ / "rod.pvd");
  EXPECT_NE(pvd.find("timestep=\"0.02\" part=\"0\" file=\"rod/rod_000002.vtu\""),
            std::string::npos);
  const auto rod = read_vtu_arrays(contents(folder_ / "rod/rod_000002.vtu"));
  EXPECT_EQ(rod.at("types").numbers<std::uint8_t>(), (std::vector<std::uint8_t>{3, 3, 3, 3}));
  EXPECT_EQ(rod.at("radius [m]").numbers<float>(), std::vector<float>(5, 1e-3f));

  const auto none = read_vtu_arrays(contents(folder_ / "constraints/constraints_000001.vtu"));
  EXPECT_EQ(none.at("law").numbers<float>(), std::vector<float>{-1});
  EXPECT_EQ(none.at("force [N]").numbers<float>(), (std::vector<float>{0, 0, 0}));

  const auto some = read_vtu_arrays(contents(folder_ / "constraints/constraints_000002.vtu"));
  EXPECT_EQ(some.at("Points").numbers<double>(), (std::vector<double>{1e-3, 2e-3, 3e-3}));
  EXPECT_EQ(some.at("force [N]").numbers<float>(), (std::vector<float>{0, 0, 0.5}));
  EXPECT_EQ(some.at("lambda [N]").numbers<float>(), std::vector<float>{0.5});
  EXPECT_EQ(some.at("violation [m]").numbers<float>(), std::vector<float>{0});
  EXPECT_EQ(some.at("mode").numbers<float>(), std::vector<float>{3});
  EXPECT_EQ(some.at("law").numbers<float>(), std::vector<float>{0});
  EXPECT_EQ(some.count("law 0 is pull"), 1u);
}

TEST_F(Recorders, VtuHoldsWhatComponentsDrawThemselves) {
  ASSERT_EQ(run("<Curve name='rod'/><Flag name='flag'/><VtuRecorder/>", 3), "");
  const auto flag = read_vtu_arrays(contents(folder_ / "flag/flag_000002.vtu"));
  EXPECT_EQ(flag.at("Points").numbers<double>(), (std::vector<double>{0, 0, 0, 0, 0, 2}));
  EXPECT_EQ(flag.at("types").numbers<std::uint8_t>(), std::vector<std::uint8_t>{3});
  // It draws nothing in step 3.
  EXPECT_FALSE(std::filesystem::exists(folder_ / "flag/flag_000003.vtu"));
  EXPECT_EQ(contents(folder_ / "flag.pvd").find("flag_000003"), std::string::npos);
}

TEST_F(Recorders, VtuEverySoManyStepsOrSeconds) {
  const auto records = [&](const std::string& attributes) {
    EXPECT_EQ(run("<Curve name='rod'/><VtuRecorder " + attributes + "/>", 10), "");
    const std::string pvd = contents(folder_ / "rod.pvd");
    std::string steps;
    for (auto at = pvd.find("rod_0"); at != std::string::npos; at = pvd.find("rod_0", at + 1)) {
      steps += std::to_string(std::stoi(pvd.substr(at + 4, 6))) + " ";
    }
    return steps;
  };
  EXPECT_EQ(records("every='4'"), "0 4 8 ");
  EXPECT_EQ(records("interval='50 ms'"), "0 5 10 ");
  EXPECT_EQ(records("interval='25 ms'"), "0 3 5 8 10 ");  // the first step at or after each 25 ms
}

TEST_F(Recorders, AShorterRunLeavesNothingOfTheLongerOne) {
  const std::string rod = "<Curve name='rod'/><VtuRecorder/>";
  ASSERT_EQ(run(rod + "<CsvProbe columns='/rod.tip'/>", 3), "");
  std::ofstream(folder_ / "notes.txt") << "mine";
  std::ofstream(folder_ / "rod/notes.txt") << "mine";
  ASSERT_EQ(run(rod, 1), "");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "rod/rod_000001.vtu"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "rod/rod_000002.vtu"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "probe.csv")) << "of the run before";
  EXPECT_TRUE(std::filesystem::exists(folder_ / "notes.txt")) << "not ours to remove";
  EXPECT_TRUE(std::filesystem::exists(folder_ / "rod/notes.txt"));
}

TEST_F(Recorders, AListThatWasTamperedWithRemovesNothingOutside) {
  std::filesystem::create_directories(folder_ / "inside");
  const auto outside = std::filesystem::path(folder_.string() + "_outside");
  std::filesystem::create_directories(outside);
  std::ofstream(outside / "a.vtu") << "mine";
  std::filesystem::create_directory_symlink(outside, folder_ / "link");
  std::ofstream(folder_ / ".sutura_files")
      << outside.string() << "/a.vtu\n../" << outside.filename().string() << "/a.vtu\nlink/*.vtu\n";
  ASSERT_EQ(run("<Curve name='rod'/><VtuRecorder/>", 1), "");
  EXPECT_TRUE(std::filesystem::exists(outside / "a.vtu"));
}

TEST_F(Recorders, TwoRunsDoNotShareAFolder) {
  const std::string scene = "<Curve name='rod'/><CsvProbe columns='/rod.tip'/>";
  ASSERT_EQ(run(scene, 0), "");
  ASSERT_EQ(simulation_->start_recording(), "");  // and goes on
  const auto first = std::move(simulation_);
  EXPECT_NE(run(scene, 0).find("another run is writing to " + folder_.string()), std::string::npos);
  EXPECT_EQ(first->finish_recording(), "");
  EXPECT_EQ(run(scene, 0), "");
}

TEST_F(Recorders, ARunThatGoesOnOwnsTheFolderAndRemovesNothing) {
  const std::string scene = "<Curve name='rod'/><CsvProbe columns='/rod.tip'/>";
  ASSERT_EQ(run(scene, 2), "");
  const auto size = std::filesystem::file_size(folder_ / "probe.csv");
  ASSERT_EQ(simulation_->resume_recording(), "");
  const auto first = std::move(simulation_);
  EXPECT_NE(run(scene, 0).find("another run is writing to " + folder_.string()), std::string::npos);
  EXPECT_EQ(first->finish_recording(), "");
  EXPECT_EQ(std::filesystem::file_size(folder_ / "probe.csv"), size);
}

TEST_F(Recorders, OneVtuRecorderPerScene) {
  EXPECT_NE(run("<Curve/><VtuRecorder name='a'/><VtuRecorder name='b'/>", 0).find("overwrite"),
            std::string::npos);
}

TEST_F(Recorders, AFolderThatCannotBeWrittenIsAnError) {
  std::filesystem::create_directories(folder_);
  std::ofstream(folder_ / "rod") << "in the way";
  const std::string error = run("<Curve name='rod'/><VtuRecorder/>", 1);
  EXPECT_NE(error.find("rod"), std::string::npos) << error;
}

TEST(FileNames, OfPaths) {
  EXPECT_EQ(file_name_of("/skin/tissue", {}), "skin_tissue");
  EXPECT_EQ(file_name_of("/suture", {"constraints"}), "suture");
  EXPECT_EQ(file_name_of("/constraints", {"constraints"}), "constraints_2");
  EXPECT_EQ(file_name_of("/a_b", {"constraints", "a_b", "a_b_2"}), "a_b_3");
}

}  // namespace
}  // namespace sutura::output
