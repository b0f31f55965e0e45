// The plainest textbook scenes of scenes/validation, by their own probes.
#include <cmath>
#include <numbers>

#include "csv.h"
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

// a01: 2 EI/L^2 across the end of a cantilever. 20 beams of fourth order: the reference's own
// tolerance is 0.5 % of L; measured 1e-5. It is inextensible, the thread 1e-6 from it.
TEST(Textbook, CantileverUnderEndLoad) {
  TextRun run = TextRun::file("validation/cantilever_end_load.xml");
  ASSERT_TRUE(run);
  run.run(0.1);
  const Table a01 = reference("a01_elastica_end_load.csv");
  for (std::size_t i = 0; i < a01.rows.size(); ++i) {
    if (a01.number(i, "PL2_over_EI") != 2) continue;
    const Vec3 u = run.vector("/end", "displacement") / 0.1;
    EXPECT_NEAR(-u.z(), a01.number(i, "w_over_L"), 1e-4);
    EXPECT_NEAR(-u.x(), a01.number(i, "u_over_L"), 1e-4);
    return;
  }
  FAIL() << "no such load in the table";
}

// a02: the circle closes. The reference asks for 1e-3 of L with 20 beams; beams of constant
// curvature are exact but for the arc's fourth order.
TEST(Textbook, CantileverUnderEndMoment) {
  TextRun run = TextRun::file("validation/cantilever_end_moment.xml");
  ASSERT_TRUE(run);
  run.run(0.1);
  EXPECT_LT(run.vector("/end", "position").norm(), 1e-4 * 0.1);
  EXPECT_NEAR(run.number("/end", "curvature"), 2 * std::numbers::pi / 0.1, 1e-4 * 63);
}

// a08: phi = T L / GJ, exact for a straight round rod. The grip gives way by T / 10 N m, 1e-6 of
// the turn; the attribute rounds it to six digits.
TEST(Textbook, TwistedRod) {
  TextRun run = TextRun::file("validation/twisted_rod.xml");
  ASSERT_TRUE(run);
  run.run(1);
  EXPECT_NEAR(run.vector("/grasper", "moment").x(), 2e-5, 1e-5 * 2e-5);
  const Table a08 = reference("a08_torsion.csv");
  for (std::size_t i = 0; i < a08.rows.size(); ++i)
    if (a08.text(i, "rod") == "nylon 2-0" && a08.number(i, "end torque N m") == 2e-5) {
      EXPECT_NEAR(run.number("/middle", "twist"), a08.number(i, "end twist rad") / 0.05, 1e-3);
      return;
    }
  FAIL() << "no such torque in the table";
}

// Cook, Malkus and Plesha: 23.96 F/(E t) for fine meshes in plane stress with nu = 1/3. 32 x 32
// cells of smoothed tetrahedra are second order; 0.5 % is what their corner singularity leaves.
TEST(Textbook, CooksMembrane) {
  TextRun run = TextRun::file("validation/cooks_membrane.xml");
  ASSERT_TRUE(run);
  run.run(0.05);
  const Vec3 u = run.vector("/middle", "displacement");
  EXPECT_NEAR(u.y(), 23.96 * 5e-5 / (100e3 * 1e-3), 5e-3 * 1.2e-5);
  EXPECT_NEAR(u.z(), 0, 1e-9 * u.y());  // symmetric about the middle plane
}

// Uniform stress is in the space of linear tetrahedra: exact but for the supports, a million times
// stiffer than the tissue around each node, and for the tolerance of the step.
TEST(Textbook, PatchUnderTraction) {
  TextRun run = TextRun::file("validation/patch_traction.xml");
  ASSERT_TRUE(run);
  run.run(0.05);
  const Vec3 strain(0.01, -0.003, -0.003);  // T/E, -nu T/E: the corotational law is linear in both
  const Vec3 u = run.vector("/corner", "displacement");
  EXPECT_LT((u - strain.cwiseProduct(Vec3(30e-3, 20e-3, 10e-3))).norm(), 1e-5 * 3e-4);
  EXPECT_LT((run.vector("/piece", "stress") - Vec3(100, 0, 0)).norm(), 1e-4 * 100);
  EXPECT_LT(run.vector("/piece", "shear_stress").norm(), 1e-4 * 100);
}

/// Love 1929: settlement of the surface of a half space under a rectangle, as a sum over corners.
Real love(Real x, Real y, Real half, Real pressure, Real young, Real poisson) {
  const auto corner = [](Real b, Real l) {
    const Real sign = (b > 0 ? 1 : -1) * (l > 0 ? 1 : -1);
    b = std::abs(b);
    l = std::abs(l);
    return sign * (b * std::asinh(l / b) + l * std::asinh(b / l));
  };
  Real sum = 0;
  for (const int i : {-1, 1})
    for (const int j : {-1, 1}) sum += corner(half + i * x, half + j * y);
  return pressure * (1 - poisson * poisson) / (std::numbers::pi * young) * sum;
}

// Two cells across the half width of the punch: 3 % too stiff, and the block is six half widths
// deep. Half of the cells are 15 % off: the tolerance would see a wrong pressure or constant.
TEST(Textbook, PunchOnAHalfSpace) {
  TextRun run = TextRun::file("validation/punch.xml");
  ASSERT_TRUE(run);
  run.run(0.01);
  const Real dent =
      run.vector("/away", "displacement").z() - run.vector("/middle", "displacement").z();
  const Real expected = love(0, 0, 4e-3, 100, 10e3, 0.3) - love(16e-3, 0, 4e-3, 100, 10e3, 0.3);
  EXPECT_NEAR(dent, expected, 0.05 * expected);
}

/// Force of the rigid punch over that on a half space: 1.1523 E* d L, pi times the capacity of a
/// square plate of side 1 (0.36679), with d less what the point 16 mm away sinks under that force.
Real punch_ratio(const std::string& cells) {
  TextRun run = TextRun::file("validation/rigid_punch.xml", {{"/block_mesh.cells", cells}});
  if (!run) return 0;
  run.run(0.01);
  const Real force = -4 * run.vector("/punch", "reaction").z();
  const Real d = 0.1e-3 + run.vector("/away", "displacement").z();
  const Real per_force = 1 / (1.1523 * 8e-3) - 1 / (std::numbers::pi * 16e-3);
  return force * per_force * (1 - 0.3 * 0.3) / (10e3 * d);
}

// The pressure is singular at the edge, where elements of size h make the punch wider by a share of
// h: the error is of first order, 24 % with one element across half the punch, 12 % with two. What
// is left without it is a block of six half widths instead of a half space.
TEST(Textbook, RigidPunchOnAHalfSpace) {
  const Real coarse = punch_ratio("6 6 6"), fine = punch_ratio("12 12 12");
  EXPECT_NEAR(fine, 1.12, 0.02);
  EXPECT_NEAR(2 * fine - coarse, 1, 0.02);
}

// Implicit Euler: z_n = v0 t - g h^2 n (n + 1) / 2, whatever the spin; the body stays rigid.
TEST(Textbook, BlockInFreeFlight) {
  TextRun run = TextRun::file("validation/free_flight.xml");
  ASSERT_TRUE(run);
  const Real start = run.simulation().bodies()[0].body->energy();
  // 2 g thrown and spun: half m v^2 and half I w^2, the lumped I of so coarse a mesh a third
  // larger.
  const Real spin = 0.5 * 2e-3 / 12 * (2 * 0.01 * 0.01) * 100;
  EXPECT_NEAR(start, 0.5 * 2e-3 * (0.25 + 1) + spin, spin);
  EXPECT_GT(start, 0.5 * 2e-3 * 1.25 + 0.9 * spin);
  run.run(0.02);
  Vec3 arm = run.vector("/corner", "position") - run.vector("/middle", "position");
  // 0.2 rad; the products of inertia of the lumped mesh make it tumble later.
  EXPECT_NEAR(std::atan2(arm.z(), arm.y()) - std::numbers::pi / 4, 0.2, 0.002);
  run.run(0.2);
  const int n = 200;
  const Vec3 middle = run.vector("/middle", "position");
  EXPECT_NEAR(middle.x(), 0.1, 1e-6);
  EXPECT_NEAR(middle.z(), 0.2 - 9.81 * 1e-6 * n * (n + 1) / 2, 1e-6);
  EXPECT_NEAR(run.vector("/tissue", "momentum").x(), 1e-3, 1e-6);
  arm = run.vector("/corner", "position") - middle;
  EXPECT_NEAR(arm.norm(), std::sqrt(150.) * 1e-3, 1e-3 * 12e-3);
}

}  // namespace
}  // namespace sutura::testing
