// Tissue on tools and on tissue, against closed forms. Steps of a second: inertia counts for
// nothing, and every step ends in balance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "contact_scenes.h"
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

constexpr Real young = 20e3;

std::string down_by(const std::string& mm) {
  return "<Track name='press' times='0 2 s' positions='0 0 0  0 0 -" + mm + " mm'/>";
}
const std::string quasi_static = "dt='1 s' gravity='0 0 0'";

/// Runs to 3 s; every step must be solved.
void press(TextRun& run) {
  for (int i = 0; i < 3; ++i) {
    const StepReport& report = run.simulation().step();
    EXPECT_TRUE(report.solved) << i;
    EXPECT_TRUE(report.faults.empty());
  }
}

// A block between two plates without friction is in a state of uniform stress, which linear
// tetrahedra hold exactly: F = E A e, to first order in the strain.
TEST(TissueContact, ABlockBetweenTwoPlatesIsUniform) {
  TextRun run("<plugin name='contact'/>" + block("skin", "-5 -4 0 5 4 10", "4 3 5") +
                  down_by("0.01") +
                  "<Tool name='table' shape='plane'/><Tool name='plate' shape='plane' axis='0 0 "
                  "-1' centre='0 0 10 mm' motion='press'/>"
                  "<Contact name='below' first='/skin/tissue' tool='table' friction='0'/>"
                  "<Contact name='above' first='/skin/tissue' tool='plate' friction='0'/>",
              quasi_static);
  ASSERT_TRUE(run) << run.said();
  press(run);
  const Real expected = young * 80e-6 * 1e-3;  // N: 0.01 mm of 10 mm
  EXPECT_NEAR(run.vector("/table", "force").z(), -expected, 3e-3 * expected);
  EXPECT_NEAR(run.vector("/plate", "force").z(), expected, 3e-3 * expected);
}

// Two blocks on each other whose meshes do not match, between the same plates: the force goes
// through, and the two together are as soft as one of their height. Where nodes press on triangles
// the pressure is uneven, and the blocks are held back by a share of one layer of elements: within
// 3 % here.
TEST(TissueContact, TwoBlocksPressedTogetherAreAsSoftAsOne) {
  TextRun run("<plugin name='contact'/>" + block("low", "-5 -4 0 5 4 10", "4 3 5") +
                  block("high", "-5 -4 10 5 4 20", "5 4 4") + down_by("0.02") +
                  "<Tool name='table' shape='plane'/><Tool name='plate' shape='plane' axis='0 0 "
                  "-1' centre='0 0 20 mm' motion='press'/>"
                  "<Contact name='below' first='/low/tissue' tool='table' friction='0'/>"
                  "<Contact name='above' first='/high/tissue' tool='plate' friction='0'/>"
                  "<Contact name='between' first='/high/tissue' second='/low/tissue' "
                  "friction='0'/>",
              quasi_static);
  ASSERT_TRUE(run) << run.said();
  press(run);
  const Real expected = young * 80e-6 * 1e-3;  // N: 0.02 mm of 20 mm
  const Vec3 below = run.vector("/table", "force"), above = run.vector("/plate", "force");
  EXPECT_NEAR(above.z(), expected, 0.03 * expected);
  // What goes in at the top comes out at the bottom, and through the middle: to the tolerance of
  // the step, a hundredth of the forces; measured 1e-6 of them.
  EXPECT_LT((below + above).norm(), 1e-4 * expected);
  EXPECT_LT((run.vector("/between", "force") - above).norm(), 1e-4 * expected);
}

// A block lies on another one, level and tilted, nodes on edges of its triangles: it is at rest,
// does not creep, and no step has to look for which of two triangles a node is on.
TEST(TissueContact, ABlockLiesStillOnAnother) {
  for (const Real tilt : {0., 5., 10., 15., 20., 25.}) {  // below atan(0.5), 26.6 degrees
    const Real angle = tilt * std::numbers::pi / 180;
    TextRun run(
        "<plugin name='contact'/>" +
            block("low", "-15 -10 -6 15 10 0", "7 5 2", "<Attach box='-15 -10 -6 15 10 -6 mm'/>") +
            block("high", "-5 -4 0 5 4 6", "4 3 3") +
            "<TissueProbe name='top' tissue='/high/tissue' point='0 0 6 mm'/>"
            "<Contact first='/high/tissue' second='/low/tissue' friction='0.5'/>",
        "dt='10 ms' gravity='" + text_of(9.81 * Vec3(std::sin(angle), 0, -std::cos(angle))) + "'");
    ASSERT_TRUE(run) << run.said();
    run.run(1);
    const Vec3 before = run.vector("/top", "position");
    Index most = 0;
    while (run.simulation().time() < 5 - 1e-9) {
      const StepReport& report = run.simulation().step();
      EXPECT_TRUE(report.solved) << tilt << ' ' << report.time;
      most = std::max(most, report.passes);
    }
    EXPECT_LE(most, 3) << tilt;
    EXPECT_LT((run.vector("/top", "position") - before).norm(), 1e-9) << tilt;  // as in the incline
  }
}

/// A quarter of a layer on a rigid bed, 15 mm deep, as wide as that from the middle, and a tool
/// that presses on the middle.
std::string quarter(const std::string& mm, const std::string& tool) {
  return "<plugin name='contact'/>" +
         block("skin", "0 0 -15 15 15 0", "14 14 14",
               "<Attach name='bed' box='0 0 -15 15 15 -15 mm'/>"
               "<Attach name='x' box='0 0 -14.9 0 15 0 mm' directions='x'/>"
               "<Attach name='y' box='0 0 -14.9 15 0 0 mm' directions='y'/>") +
         down_by(mm) + "<Tool name='tool' motion='press' " + tool +
         "/><Contact first='/skin/tissue' tool='tool' friction='0'/>";
}
constexpr Real nu = 0.3, depth = 15e-3, reduced = young / (1 - nu * nu);
/// What the bed takes off the displacement under a force: alpha F / (pi E* depth) (Dimitriadis et
/// al. 2002, eq. 10: a layer that is glued to its bed).
constexpr Real alpha = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu);

// A ball on a half space: 4/3 E* sqrt(R) d^1.5 (Hertz). On a layer, with x = sqrt(R d) / depth =
// 0.21, it is 1 - 2 alpha x / pi + (2 alpha x / pi)^2 times that, 1.22, and 0.2 % more by the next
// terms. Elements are a third of the radius of the contact, 3.2 mm: 5 %.
TEST(TissueContact, ABallDentsAsHertzSays) {
  TextRun run(quarter("0.5", "shape='sphere' radius='20 mm' centre='0 0 20 mm'"), quasi_static);
  ASSERT_TRUE(run) << run.said();
  press(run);
  const Real d = 0.5e-3, R = 20e-3, x = -2 * alpha * std::sqrt(R * d) / depth / std::numbers::pi;
  const Real expected = 4. / 3 * reduced * std::sqrt(R) * std::pow(d, 1.5) * (1 + x + x * x);
  const Real force = 4 * run.vector("/tool", "force").z();
  RecordProperty("force_against_closed_form", std::to_string(force / expected));
  EXPECT_NEAR(force, expected, 0.05 * expected);
  // Nodes lie on the ball; between two of them, a diagonal of a cell apart, the edge cuts into it.
  const Real diagonal = std::sqrt(2.) * 15e-3 / 14;
  EXPECT_GT(run.number("/contact", "distance"), -1.05 * diagonal * diagonal / (8 * R));
}

// A flat cylinder: 2 a E* d (Boussinesq); the bed takes off as much as above. What the mesh makes
// of the radius is uncertain by a part of an element, a third of it: 10 %.
TEST(TissueContact, AFlatPunchPressesAsBoussinesqSays) {
  TextRun run(quarter("0.1", "shape='cylinder' radius='3.2 mm' length='10 mm' centre='0 0 5 mm'"),
              quasi_static);
  ASSERT_TRUE(run) << run.said();
  press(run);
  const Real a = 3.2e-3;
  const Real expected = 2 * a * reduced * 0.1e-3 / (1 + 2 * alpha * a / depth / std::numbers::pi);
  const Real force = 4 * run.vector("/tool", "force").z();
  RecordProperty("force_against_closed_form", std::to_string(force / expected));
  EXPECT_NEAR(force, expected, 0.1 * expected);
}

// The same of other radii: nodes within the rim are pressed and those beyond are free, so the mesh
// makes the radius smaller, by half an element at most, and never larger. Linear tetrahedra are too
// stiff: 3 %. Triangles at the rim that were held by the nearest side of the tool added up to 20 %,
// or nothing, by way of the passes, where nodes are some um within or beyond the rim: 3.2 to 3.22.
TEST(TissueContact, AFlatPunchIsNoWiderThanItIs) {
  const Real element = 15e-3 / 14;
  for (const Real a : {2.4e-3, 2.7e-3, 3.0e-3, 3.2e-3, 3.21e-3, 3.22e-3, 3.6e-3, 4.0e-3}) {
    TextRun run(quarter("0.1", "shape='cylinder' radius='" + std::to_string(a) +
                                   "' length='10 mm' centre='0 0 5 mm'"),
                quasi_static);
    ASSERT_TRUE(run) << run.said();
    press(run);
    const Real expected = 2 * a * reduced * 0.1e-3 / (1 + 2 * alpha * a / depth / std::numbers::pi);
    const Real force = 4 * run.vector("/tool", "force").z();
    EXPECT_LT(force, 1.03 * expected) << a;
    EXPECT_GT(force, (1 - element / (2 * a)) * expected) << a;
  }
}

}  // namespace
}  // namespace sutura::testing
