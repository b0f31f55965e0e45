// Cases that do not depend on the mesh: free fall, needle with thread, shear, torsion.
#include <gtest/gtest.h>

#include <cmath>

#include "reference_table.h"
#include "rod_static.h"
#include "rod_step.h"
#include "suture_shape.h"
#include "unit/thread/rod_builder.h"

namespace sutura::thread {
namespace {

/// Largest distance of a node from where implicit Euler puts it after one second of free fall.
/// `rounding`: that of the forces, relative to what counts as at work in a beam that does nothing.
void expect_free_fall(const RodLayout& layout, Real tolerance, Real rounding) {
  const ReferenceTable table("a07d_free_fall.csv");
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    Rod rod;
    rod.build(layout);
    RodStep step(rod);
    const Real h = table.number(i, "h s");
    const int steps = static_cast<int>(table.number(i, "steps"));
    for (int k = 0; k < steps; ++k)
      ASSERT_GT(step.advance(rod, h, Vec3(0, 0, -9.81), VecX::Zero(rod.dofs()), rounding), 0);
    const Vec3 fall(0, 0, table.number(i, "x after 1 s implicit Euler"));
    Real worst = 0;
    for (Index n = 0; n < rod.nodes(); ++n)
      worst = std::max(
          worst,
          (rod.poses(Configuration::current)[n].position - layout.start[n].position - fall).norm());
    EXPECT_LT(worst, tolerance) << "h " << h;
  }
}

TEST(FreeFall, ThreadFollowsTheIntegratorExactly) {
  // Rounding of up to 1000 additions of numbers near 5 m.
  expect_free_fall(straight_layout(0.1, 50, nylon()), 1e-12, 1e-2);
}

TEST(FreeFall, NeedleAndThreadFallTogether) {
  const SutureShape shape{.needle_length = 26e-3,
                          .needle_angle = std::numbers::pi,
                          .thread_length = 0.1,
                          .thread_rest = {}};
  RodLayout layout;
  for (Index i = 0; i <= 62; ++i) {
    const Real s =
        i <= 12 ? 26e-3 * static_cast<Real>(i) / 12 : 26e-3 + 2e-3 * static_cast<Real>(i - 12);
    layout.abscissa.push_back(s);
    layout.rest.push_back(shape.rest(s));
    if (i < 62)
      layout.sections.push_back(
          i < 12 ? Section{.radius = 0.325e-3, .young = 190e9, .poisson = 0.3, .density = 7850}
                 : nylon());
  }
  layout.start = layout.rest;
  // A node near 5 m is rounded to 1e-15 m, which over a 2 mm beam of steel (EA 63 kN) is a force of
  // 3e-8 N, 1e-4 of the needle's weight and of random direction in every step.
  // A beam counts 1e-10 EA as at work, 200 times that.
  expect_free_fall(layout, 1e-9, 1e-2);
}

/// Deflection of the tip under a transverse tip load, by one linear solve with the static tangent.
Real linear_deflection(Rod& rod, Real load) {
  BlockTridiagonal tangent;
  assemble_static(rod, Vec3::Zero(), tangent);
  EXPECT_TRUE(tangent.factor());
  VecX x = VecX::Zero(rod.dofs());
  x[6 * (rod.nodes() - 1) + 2] = load;
  tangent.solve(Eigen::Ref<VecX>(x));
  return x[6 * (rod.nodes() - 1) + 2];
}

TEST(NeedleThread, StiffnessRatioDoesNotHurtTheSolve) {
  const ReferenceTable table("a13_needle_thread.csv");
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const Real a = table.number(i, "needle length m"), b = table.number(i, "thread length m");
    // Radii far below the lengths: the reference has no shear. E follows from EI.
    const auto section = [&](const char* column) {
      Section s{.radius = 1e-6, .poisson = 0.3, .density = 1000};
      s.young = table.number(i, column) / s.second_moment();
      return s;
    };
    for (const Index beams : {4, 20, 60}) {
      RodLayout layout;
      for (Index k = 0; k <= 2 * beams; ++k) {
        const Real s = k <= beams ? a * static_cast<Real>(k) / static_cast<Real>(beams)
                                  : a + b * static_cast<Real>(k - beams) / static_cast<Real>(beams);
        layout.abscissa.push_back(s);
        layout.rest.push_back({Vec3(s, 0, 0), Quat::Identity()});
        if (k < 2 * beams)
          layout.sections.push_back(section(k < beams ? "EI needle" : "EI thread"));
      }
      layout.start = layout.rest;
      Rod rod;
      rod.build(layout);
      rod.clamp(0);
      const Real expected = table.number(i, "tip deflection m");
      // The cubic beam is exact at its nodes: only rounding, amplified by the condition of the
      // chain. The reference is printed with ten digits.
      EXPECT_NEAR(linear_deflection(rod, table.number(i, "tip load N")), expected, 1e-8 * expected)
          << beams << " beams";
    }
  }
}

TEST(Shear, TimoshenkoCantileverIsExact) {
  const ReferenceTable table("a09_timoshenko.csv");
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    if (table.text(i, "section") != "circle") continue;
    Section s = nylon();
    s.poisson = table.number(i, "nu");
    const Real length = table.number(i, "L/d") * 2 * s.radius;
    Rod rod;
    rod.build(straight_layout(length, 4, s));
    rod.clamp(0);
    const Real bending = std::pow(length, 3) / (3 * s.bending_stiffness());
    const Real ratio = table.number(i, "shear deflection / bending deflection");
    // Exact at nodes; the table has ten digits of the ratio.
    EXPECT_NEAR(linear_deflection(rod, 1) / bending, 1 + ratio, 1e-9) << "L/d " << length;
  }
}

TEST(Torsion, IsExactBeyondTurns) {
  const ReferenceTable table("a08_torsion.csv");
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    Section s;
    const std::string& rod_name = table.text(i, "rod");
    if (rod_name == "nylon 2-0")
      s = nylon();
    else if (rod_name == "polypropylene 4-0")
      s = {.radius = 0.0875e-3, .young = 1.5e9, .poisson = 0.4, .density = 910};
    else
      s = {.radius = 0.3e-3, .young = 190e9, .poisson = 0.3, .density = 7850};
    ASSERT_NEAR(s.torsion_stiffness(), table.number(i, "GJ N m2"), 1e-9 * s.torsion_stiffness());
    const Real torque = table.number(i, "end torque N m");
    for (const Index beams : {4, 10}) {
      Rod rod;
      rod.build(straight_layout(0.05, beams, s));
      rod.clamp(0);
      VecX load = VecX::Zero(rod.dofs());
      load[6 * beams + 3] = torque;
      // 20 rad on 10 and on 4 beams: more than half a turn per beam, counted by the state.
      // Residual 1e-12 of torque over a beam length.
      const auto report = equilibrium(rod, Vec3::Zero(), load, 1e-11 * torque / 0.01);
      EXPECT_TRUE(report.converged);
      Real twist = 0;
      for (const Real t : rod.twist()) twist += t;
      const Real expected = table.number(i, "end twist rad");
      EXPECT_NEAR(twist, expected, 1e-9 * expected) << rod_name << ' ' << torque << ' ' << beams;
    }
  }
}

}  // namespace
}  // namespace sutura::thread
