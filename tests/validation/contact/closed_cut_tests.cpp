// A cut whose walls lie on each other, with a Contact of the tissue with itself.
#include <gtest/gtest.h>

#include <cmath>

#include "contact_scenes.h"
#include "scenes/text_run.h"
#include "sutura/end_note.h"

namespace sutura::testing {
namespace {

/// A block of 24 x 16 x 6 mm on a bed; its long sides are pressed together with 4 kPa.
std::string pressed(const std::string& cuts, const std::string& factors) {
  const auto load = [&](const std::string& name, const std::string& y) {
    return "<TissueLoad name='" + name + "' box='-13 " + y + " -7 13 " + y +
           " 1 mm' pressure='4 kPa' times='0 0.3 0.6 s' factors='" + factors + "'/>";
  };
  return "<plugin name='contact'/><BlockMesh box='-12 -8 -6 12 8 0 mm' cells='12 8 4' " + cuts +
         "/><Tissue young='30 kPa' poisson='0.4' damping_stiffness='10 ms'/>"
         "<Attach box='-13 -9 -6 13 9 -6 mm'/><TissueProbe name='left' point='5 -8 -1 mm'/>"
         "<TissueProbe name='right' point='0 8 0 mm'/><Distance from='left' to='right'/>" +
         load("a", "-8") + load("b", "8");
}
const std::string one_cut = "cuts='-6 0 -3 6 0 0 mm'";
const std::string touching = "<Contact friction='0.3'/>";

struct Squeezed {
  Real width = 0;   ///< across the block (m)
  Real energy = 0;  ///< J
  Real touches = 0;
  Real most_passes = 0;
};
Squeezed squeeze(const std::string& content, const std::string& dt) {
  TextRun run(content, "gravity='0 0 0' dt='" + dt + "'");
  EXPECT_TRUE(run) << run.said();
  EXPECT_EQ(run.said(), "");
  Squeezed out;
  while (run && run.simulation().time() < 1 - 1e-9) {
    const StepReport& report = run.simulation().step();
    EXPECT_TRUE(report.solved && report.faults.empty()) << dt << ", step " << report.step;
    out.most_passes = std::max(out.most_passes, static_cast<Real>(report.passes));
  }
  out.width = run.number("/distance", "distance");
  out.energy = run.number("/tissue", "energy");
  if (run.simulation().find("/contact") != nullptr) out.touches = run.number("/contact", "touches");
  return out;
}

// Walls that are pressed together and stick carry what the whole block carries there. What steps
// leave of their balance, 0.01 of the forces at most, is the only difference, and the block comes
// to rest; measured 1e-7 of how far it is pressed, and 2e-7 of the energy.
TEST(ClosedCut, PressedTogetherIsAsTheWholeBlock) {
  const Real straight = std::sqrt(5e-3 * 5e-3 + 16e-3 * 16e-3 + 1e-3 * 1e-3);
  for (const char* dt : {"2 ms", "10 ms", "50 ms"}) {
    const Squeezed whole = squeeze(pressed("", "0 1 1"), dt);
    const Squeezed cut = squeeze(pressed(one_cut, "0 1 1") + touching, dt);
    const Real by = straight - whole.width;
    EXPECT_GT(by, 1e-3);
    EXPECT_NEAR(cut.width, whole.width, 1e-5 * by) << dt;
    EXPECT_NEAR(cut.energy, whole.energy, 1e-5 * whole.energy) << dt;
    EXPECT_GE(cut.touches, 10) << dt;
    EXPECT_LE(cut.most_passes, 5) << dt;
  }
}

// Where a cut ends its nodes belong to both walls, whose normals cancel out. Of elements flatter
// than half an edge such a node was taken for one that has come in through their top, by rounding,
// and thrown out by millimetres. Nothing moves a block without loads.
TEST(ClosedCut, AtRestItStaysAtRest) {
  const std::string straight = "-6 0.2 -4 6 0.2 0", bed = "  -6 0.2 -4 6 4.2 -4",
                    across = "  0 -4 -4 0 4 0";
  for (const std::string& cuts : {straight, straight + bed, straight + across})
    for (const char* cells : {"8 6 6", "8 8 6", "6 4 12"}) {
      const auto of = [&](const std::string& contact) {
        return "<plugin name='contact'/><BlockMesh box='-12 -7.8 -6 12 8.2 0 mm' cells='" +
               std::string(cells) + "' cuts='" + cuts +
               " mm'/><Tissue young='30 kPa' poisson='0.4'/>"
               "<Attach box='-12 -8 -6 12 9 -6 mm'/>" +
               contact;
      };
      TextRun run(of(touching));
      ASSERT_TRUE(run) << cuts << ", " << cells << ": " << run.said();
      run.run(0.1);
      EXPECT_LT(run.number("/tissue", "max_displacement"), 1e-12) << cuts << ", " << cells;
      TextRun alone(of(""));  // no false alarm where nothing keeps the walls apart
      alone.run(0.1);
      EXPECT_EQ(dynamic_cast<const EndNote&>(*alone.simulation().find("/tissue")).end_note(), "");
    }
}

// A cube that is cut free all around by five cuts, which meet in edges and corners, is held by
// nothing: pulled without friction it flies out.
TEST(ClosedCut, ACubeThatIsCutFreeIsFree) {
  TextRun run(
      "<plugin name='contact'/><BlockMesh box='-12 -8 -6 12 8 0 mm' cells='12 8 6' "
      "cuts='-4 -4 -4 -4 4 0  4 -4 -4 4 4 0  -4 -4 -4 4 -4 0  -4 4 -4 4 4 0  -4 -4 -4 4 4 -4 mm'/>"
      "<Tissue young='30 kPa' poisson='0.4' damping_stiffness='10 ms'/>"
      "<Attach box='-12 -8 -6 12 8 -6 mm'/><TissueProbe point='0 0 -1 mm'/>"
      "<TissueLoad box='-3.9 -3.9 -0.1 3.9 3.9 0.1 mm' force='0 0 8 mN'/>"
      "<Contact friction='0'/>");
  ASSERT_TRUE(run) << run.said();
  const Vec3 before = run.vector("/tissue_probe", "position");
  run.run(0.1);
  // 8 mN on 8 x 8 x 4 mm of 1 g/cm^3 is 31 m/s^2, so 156 mm in 0.1 s; by steps of 10 ms a tenth
  // more.
  EXPECT_GT((run.vector("/tissue_probe", "position") - before).z(), 0.14);
}

// Cut right through and pressed along the block: what goes in at one end goes through the walls and
// comes out at the other. The walls stay flat to a few degrees, so that friction takes no part of
// it; what else is lost is the tolerance of the step, a hundredth of the forces at most.
TEST(ClosedCut, WallsPressWithWhatPressesThem) {
  for (const char* friction : {"0", "0.3"}) {
    TextRun run(
        std::string("<plugin name='contact'/><BlockMesh box='-12 -5 -4 12 5 4 mm' "
                    "cells='12 5 4' cuts='0 -5 -4 0 5 4 mm'/><Tissue young='60 kPa' "
                    "poisson='0.3' damping_stiffness='10 ms'/><Track name='hand' "
                    "times='0 0.3 s' positions='0 0 0  1 0 0 mm'/><Attach name='in' box='-12 "
                    "-5 -4 -12 5 4 mm' motion='hand'/><Attach name='out' box='12 -5 -4 12 5 "
                    "4 mm'/><Contact friction='") +
        friction + "'/>");
    ASSERT_TRUE(run) << run.said();
    run.run(0.8);
    const Real in = run.vector("/in", "reaction").x(), out = run.vector("/out", "reaction").x();
    // About E A e, as the ends are held across: 60 kPa, 80 mm^2, 1 of 24 mm.
    EXPECT_NEAR(in, 0.2, 0.02);
    EXPECT_NEAR(out, -in, 1e-3 * in);
    EXPECT_NEAR(run.number("/contact", "normal_force"), in, 5e-3 * in) << friction;
  }
}

// Two cuts of 3 mm that cross, one of them from side to side: their walls meet in an edge.
TEST(ClosedCut, CutsMayCross) {
  const std::string cuts = "cuts='-6 0 -3 6 0 0  0 -8 -3 0 8 0 mm'";
  const Squeezed whole = squeeze(pressed("", "0 1 1"), "10 ms");
  const Squeezed cut = squeeze(pressed(cuts, "0 1 1") + touching, "10 ms");
  EXPECT_GE(cut.touches, 10);
  // The lips of the cut along the load are free to part at the surface, where the block is
  // stretched.
  EXPECT_NEAR(cut.energy, whole.energy, 0.02 * whole.energy);
}

// Pulled apart, walls do nothing to each other; and back, they carry again.
TEST(ClosedCut, PulledApartItIsAsWithoutContact) {
  const Squeezed alone = squeeze(pressed(one_cut, "0 -1 -1"), "10 ms");
  const Squeezed with = squeeze(pressed(one_cut, "0 -1 -1") + touching, "10 ms");
  EXPECT_EQ(with.touches, 0);
  EXPECT_NEAR(with.width, alone.width, 1e-9);
  const Squeezed whole = squeeze(pressed("", "0 -1 1"), "10 ms");
  const Squeezed back = squeeze(pressed(one_cut, "0 -1 1") + touching, "10 ms");
  EXPECT_GE(back.touches, 10);
  // Walls may stick a little beside where they were joined, by what the last touches slip.
  EXPECT_NEAR(back.energy, whole.energy, 2e-3 * whole.energy);
}

// A part that is cut off is moved into the rest by a millimetre: so deep is the overlap that is
// said where nothing keeps the two apart, and there is none where a Contact does.
TEST(ClosedCut, WallsThatOverlapAreSaid) {
  const std::string content =
      "<plugin name='contact'/><BlockMesh box='-6 -4 -4 6 4 0 mm' cells='12 4 4' "
      "cuts='0 -4 -4 0 4 0 mm'/><Tissue young='30 kPa' poisson='0.3' damping_stiffness='10 ms'/>"
      "<Track name='hand' times='0 0.5 s' positions='0 0 0  -1 0 0 mm'/>"
      "<Attach name='a' box='-6 -4 -4 -1 4 0 mm'/>";
  const auto note = [&](const std::string& more) {
    TextRun run(content + more);
    EXPECT_TRUE(run) << run.said();
    run.run(0.6);
    return dynamic_cast<const EndNote&>(*run.simulation().find("/tissue")).end_note();
  };
  // Both parts are held but for the cells at the cut, so that each wall belongs to one of them.
  // Walls that only lie on each other do not overlap.
  EXPECT_EQ(note("<Attach name='b' box='1 -4 -4 6 4 0 mm'/>"), "");
  const std::string driven = "<Attach name='b' box='1 -4 -4 6 4 0 mm' motion='hand'/>";
  const std::string said = note(driven);
  EXPECT_NE(said.find("by up to 1 mm"), std::string::npos) << said;
  EXPECT_EQ(note(driven + touching), "");
}

}  // namespace
}  // namespace sutura::testing
