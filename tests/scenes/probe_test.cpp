// What is read of a thread and a tissue, against the balance of forces: before the first step,
// after a state has been restored, and where an element or a limit bears more than its strain says.
#include <cmath>
#include <string>

#include "sutura/body.h"
#include "text_run.h"

namespace sutura::testing {
namespace {

// A column of 10 x 10 x 20 mm, pressed by 200 Pa on its top: so much goes through every slab of it,
// in the mean. The smoothed element has its pressure at nodes. Read off the volume of each
// tetrahedron, slabs bore +3200 to -5200 Pa at nu = 0.499.
TEST(Probe, StressOfASmoothedBodyIsWhatItBears) {
  for (const char* poisson : {"0.3", "0.499"}) {
    SCOPED_TRACE(poisson);
    std::string probes;
    for (int slab = 0; slab < 8; ++slab)
      probes += "<TissueProbe name='slab_" + std::to_string(slab) + "' box='-5 -5 " +
                std::to_string(2.5 * slab) + " 5 5 " + std::to_string(2.5 * slab + 2.5) + " mm'/>";
    TextRun run(
        "<BlockMesh box='-5 -5 0 5 5 20 mm' cells='4 4 8'/><Tissue name='column' young='100 kPa' "
        "element='smoothed' settle='true' poisson='" +
        std::string(poisson) +
        "'/><Attach name='foot' box='-5 -5 0 5 5 0 mm'/>"
        "<TissueLoad box='-5 -5 20 5 5 20 mm' traction='0 0 -200 Pa'/>" +
        probes);
    ASSERT_TRUE(run) << run.said();
    run.simulation().step();
    EXPECT_NEAR(run.vector("/foot", "reaction").z(), 0.02, 1e-6);
    // The average over a slab cuts through the averages of the element: 5 % on this mesh, 1 % on
    // one that is twice as fine.
    for (int slab = 0; slab < 8; ++slab)
      EXPECT_NEAR(run.vector("/slab_" + std::to_string(slab), "stress").z(), -200, 10) << slab;
  }
}

// What holds a settled body is known before the first step.
TEST(Probe, ReactionsOfASettledSceneAreThereAtOnce) {
  TextRun run(
      "<SutureThread name='thread' needle_length='0' tip_direction='-1 0 0' "
      "thread_length='60 mm' thread_diameter='0.4 mm' settle='true'/><Track times='0'/><Grasper "
      "name='hand' at='10 "
      "mm'/><BlockMesh box='0 0 50 20 10 60 mm' cells='6 3 3'/><Tissue name='block' young='20 kPa' "
      "settle='true'/><Attach name='wall' box='0 0 50 0 10 60 mm'/>",
      "dt='10 ms' gravity='0 0 -9.81'");
  ASSERT_TRUE(run) << run.said();
  const Real block = 2e-6 * 1000 * 9.81;  // N
  EXPECT_NEAR(run.vector("/wall", "reaction").z(), block, 1e-6);
  EXPECT_NEAR(run.vector("/block", "reaction").z(), block, 1e-6);
  const Vec3 hand = run.vector("/hand", "force"), moment = run.vector("/hand", "moment");
  run.simulation().step();
  EXPECT_GT(hand.z(), 1e-5);
  EXPECT_LT((run.vector("/hand", "force") - hand).norm(), 1e-5 * hand.norm());
  EXPECT_LT((run.vector("/hand", "moment") - moment).norm(), 1e-4 * moment.norm());
}

// 0.4 N hang on a thread whose elasticity bears 0.09 N at its limit of stretch: the field that is
// drawn says what the probe says.
TEST(Probe, AxialForceIsAllThatTheThreadBears) {
  TextRun run(
      "<SutureThread name='thread' needle_length='0' tip_direction='0 0 1' plane_normal='0 1 0' "
      "thread_length='20 mm' thread_diameter='0.2 mm' thread_young='1 GPa' thread_beams='20' "
      "clamp='start'/><Elongation limit='0.003'/><ThreadProbe name='probe' at='10.5 mm'/>"
      "<ThreadLoad at='20 mm' force='0 0 -0.4 N' times='0 0.1 s' factors='0 1'/>");
  ASSERT_TRUE(run) << run.said();
  run.run(0.5);
  EXPECT_NEAR(run.number("/probe", "tension"), 0.4, 1e-4);
  for (const BodyGeometry::Field& f : run.component<Body>("/thread").geometry().fields) {
    if (f.name == "axial force [N]") {
      EXPECT_NEAR(f.values[10], 0.4, 1e-4);
    }
  }
}

// What is read after a state has been restored is what was read when it was saved.
TEST(Probe, OutputsAreThoseOfTheRestoredState) {
  const std::string scene =
      "<SutureThread name='thread' needle_length='0' tip_direction='-1 0 0' thread_length='50 mm' "
      "clamp='start'/><ThreadLoad name='hung' at='50 mm' force='0 0 -1 mN' times='0 1 s' "
      "factors='0 1'/><BlockMesh box='0 0 50 20 10 60 mm' cells='6 3 3'/><DirectSolver "
      "name='solver'/><Tissue name='block' young='20 kPa'/><Attach box='0 0 50 0 10 60 mm'/>"
      "<TissueLoad name='pull' box='20 0 50 20 10 60 mm' force='0.1 0 0 N' times='0 1 s' "
      "factors='0 1'/>";
  TextRun run(scene), other(scene);
  ASSERT_TRUE(run && other) << run.said();
  run.run(0.3);
  ASSERT_EQ(other.simulation().restore(run.simulation().save()), "");
  EXPECT_NEAR(other.vector("/pull", "force").x(), 0.03, 1e-12);
  EXPECT_NEAR(other.number("/pull", "factor"), 0.3, 1e-12);
  EXPECT_NEAR(other.number("/hung", "factor"), 0.3, 1e-12);
  EXPECT_GT(run.number("/solver", "residual"), 0);
  EXPECT_EQ(other.number("/solver", "residual"), run.number("/solver", "residual"));
  EXPECT_GT(run.simulation().report().worst_time_error(), 0);
  EXPECT_EQ(other.simulation().report().worst_time_error(),
            run.simulation().report().worst_time_error());
}

/// A block of 10 x 10 x 5 mm between rollers, its top pressed down by a fifth.
TextRun oedometer(const char* poisson, const char* dt) {
  return TextRun(
      "<plugin name='contact'/><BlockMesh box='-5 -5 0 5 5 5 mm' cells='4 4 2'/>"
      "<Tissue name='block' young='100 kPa' element='t4' damping_stiffness='2 ms' "
      "poisson='" +
          std::string(poisson) +
          "'/><Attach box='-5 -5 0 5 5 0 mm'/>"
          "<Attach name='left' directions='x' box='-5 -5 0 -5 5 5 mm'/>"
          "<Attach name='right' directions='x' box='5 -5 0 5 5 5 mm'/>"
          "<Attach name='front' directions='y' box='-5 -5 0 5 -5 5 mm'/>"
          "<Attach name='back' directions='y' box='-5 5 0 5 5 5 mm'/>"
          "<Track name='down' times='0 0.2 s' positions='0 0 0  0 0 -1 mm'/>"
          "<Tool name='press' motion='down' shape='plane' centre='0 0 5 mm' "
          "axis='0 0 -1'/><Contact first='block' tool='press' friction='0'/>",
      std::string("gravity='0 0 0' dt='") + dt + "'");
}

// The state is uniform: F = A e (1 - nu) E / ((1 + nu) (1 - 2 nu)). The law of the element has no
// shear stiffness left where the volume is compressed by more than (1 - 2 nu) / nu, 22 % at nu =
// 0.45 and 4 % at 0.49: there it folds, to a third of that force, and the run says so.
TEST(Probe, ABodyThatIsCompressedBeyondItsLawSaysSo) {
  const Real exact = 1e-4 * 0.2 * 0.55 * 1e5 / (1.45 * 0.1);
  TextRun bears = oedometer("0.45", "5 ms");
  ASSERT_TRUE(bears) << bears.said();
  while (bears.simulation().time() < 0.3) EXPECT_TRUE(bears.simulation().step().faults.empty());
  EXPECT_NEAR(-bears.vector("/press", "force").z(), -exact, 1e-3 * exact);
  TextRun folds = oedometer("0.49", "5 ms");
  ASSERT_TRUE(folds) << folds.said();
  Index faults = 0;
  while (folds.simulation().time() < 0.3)
    for (const std::string& fault : folds.simulation().step().faults)
      faults += fault.find("compressed by more than") != std::string::npos;
  EXPECT_GT(faults, 40);
}

}  // namespace
}  // namespace sutura::testing
