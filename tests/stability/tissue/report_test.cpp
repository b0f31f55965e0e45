// What goes wrong in a scene with an asynchronous solver is said in the StepReport, and nothing
// breaks: a factorisation that fails, a worker that never answers, elements turned inside out.
#include <gtest/gtest.h>

#include <algorithm>

#include "tissue_meshes.h"
#include "tissue_scene.h"

namespace sutura::tissue {
namespace {

using test::TissueScene;

struct ReportScene {
  explicit ReportScene(const std::string& solver, const StepLimits& limits = {}) {
    const std::string file = std::string(SUTURA_BINARY_DIR) + "/report_" +
                             ::testing::UnitTest::GetInstance()->current_test_info()->name() +
                             ".msh";
    test::write_msh(test::kuhn_block({6, 2, 2}, Vec3(0.06, 0.02, 0.02)), file);
    scene = std::make_unique<TissueScene>(
        "<TetMesh file='" + file + "' unit='m'/>" + solver +
            "<Tissue young='10 kPa'/><Attach box='0 0 0 0 20 20 mm'/>",
        "0 0 -9.81", "10 ms", nullptr, limits);
    EXPECT_TRUE(scene->diagnostics.ok()) << test::all_messages(scene->diagnostics);
  }
  /// Whether the report of this step has a message that starts with the path and holds `words`.
  bool step_says(const std::string& words) {
    const auto& messages = scene->step().messages;
    return std::any_of(messages.begin(), messages.end(), [&](const std::string& m) {
      return m.starts_with("/tissue: ") && m.find(words) != std::string::npos;
    });
  }
  AsyncPreconditioner& solver() {
    return dynamic_cast<AsyncPreconditioner&>(*scene->simulation().find("/async_preconditioner"));
  }
  std::unique_ptr<TissueScene> scene;
};

TEST(Report, AHealthyRunSaysNothing) {
  ReportScene s("<AsyncPreconditioner lag='2'/>");
  for (int i = 0; i < 30; ++i) EXPECT_TRUE(s.scene->step().messages.empty()) << i;
}

// A negative viscosity, which no scene can ask for, makes A = M + (h^2 + h beta) K indefinite.
TEST(Report, AFailedFactorisationOfTheDirectSolver) {
  ReportScene s("");
  EXPECT_TRUE(s.scene->step().messages.empty());
  s.scene->tissue().model().damping_stiffness = -0.02;
  EXPECT_TRUE(s.step_says("the matrix is not positive definite"));
  s.scene->tissue().model().damping_stiffness = 0;
  EXPECT_FALSE(s.step_says("positive definite"));  // of the last step only
}

// Steps 4 and 5 cannot be factorised at all. A snapshot of one of them is with the worker: its
// failure shows up when it is due, two steps later, when the matrix itself is sound again. One pass
// a step, so that such a step is not tried again in parts.
TEST(Report, AFailedFactorisationOfTheWorker) {
  ReportScene s("<AsyncPreconditioner lag='2' refactor_iterations='0'/>",
                {.passes = 1, .substeps = 1});
  int failed_at = -1;
  for (int i = 0; i < 12; ++i) {
    s.scene->tissue().model().damping_stiffness = i >= 4 && i <= 5 ? -0.02 : 0;
    s.scene->tissue().set_state((i % 2 == 0 ? 1.05 : 1 / 1.05) * s.scene->tissue().positions(),
                                VecX::Zero(s.scene->tissue().dofs()));
    if (s.step_says("is not positive definite: keeping the older factor") && i > 5) failed_at = i;
    EXPECT_TRUE(s.scene->simulation().report().finite);
  }
  EXPECT_GE(failed_at, 6);
  EXPECT_LE(failed_at, 7);
  EXPECT_GT(s.solver().report().failed_factors, 0);
  EXPECT_TRUE(s.scene->step().messages.empty());
}

TEST(Report, AWorkerThatNeverAnswersWithAFixedLag) {
  ReportScene silent("<AsyncPreconditioner lag='2' refactor_iterations='0'/>");
  AsyncOptions o = silent.solver().options();
  o.hook = [](Index) { return false; };
  o.patience = 0.01;
  silent.solver().set_options(o);
  ReportScene healthy("<AsyncPreconditioner lag='2' refactor_iterations='0'/>");
  int said = 0;
  for (int i = 0; i < 20; ++i) {
    said += silent.step_says("the worker did not answer") ? 1 : 0;
    healthy.scene->step();
  }
  EXPECT_EQ(said, 1);
  EXPECT_EQ(silent.scene->tissue().positions(), healthy.scene->tissue().positions());
}

TEST(Report, AWorkerThatNeverAnswersWithAFreeLag) {
  ReportScene s("<AsyncPreconditioner lag='free' refactor_iterations='0' max_age='10'/>");
  AsyncOptions o = s.solver().options();
  o.hook = [](Index) { return false; };
  s.solver().set_options(o);
  for (int i = 0; i < 30; ++i)  // late once the factor of step 0 is older than max_age
    EXPECT_EQ(s.step_says("the worker is late"), i > 10) << i;
}

TEST(Report, InvertedElementsAreCounted) {
  ReportScene s("<AsyncPreconditioner lag='2'/>");
  VecX x = s.scene->tissue().positions();
  s.scene->step();  // whatever is held is held where it is put
  x.head<3>() += Vec3(0.015, 0.012, 0.012);
  s.scene->tissue().set_state(x, VecX::Zero(x.size()));
  ASSERT_GT(s.scene->tissue().inverted(), 0);
  bool said = false;
  for (int i = 0; i < 60; ++i) {
    s.scene->step();
    const bool says = s.scene->tissue().fault().find("inside out") != std::string::npos;
    EXPECT_EQ(says, s.scene->tissue().inverted() > 0) << i;
    said = said || says;
  }
  EXPECT_TRUE(said);
}

}  // namespace
}  // namespace sutura::tissue
