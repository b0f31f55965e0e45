// a01: cantilever under a dead transverse end load, against the inextensible elastica.
#include <gtest/gtest.h>

#include <cmath>

#include "reference_table.h"
#include "rod_static.h"
#include "unit/thread/rod_builder.h"

namespace sutura::thread {
namespace {

constexpr Real length = 0.1;

/// A thread of the same EI, ten times thinner: extension and shear (EI/(EA L^2) = 5.6e-6 of thread
/// N) reduced to 5.6e-8, as the reference has none.
Section inextensible() {
  Section s = nylon();
  s.radius /= 10;
  s.young *= 1e4;
  return s;
}

/// Distance of the tip from the reference, over L.
Real tip_error(const Section& section, Index beams, Real load, Real w, Real u) {
  Rod rod;
  rod.build(straight_layout(length, beams, section));
  rod.clamp(0);
  VecX force = VecX::Zero(rod.dofs());
  const Real scale = section.bending_stiffness() / (length * length);
  force[6 * beams + 2] = -load * scale;
  // Forces in equilibrium within 1e-5 of EI/L^2 axially (rounding of EA leaves 1e-8 to 1e-6), which
  // moves the tip by 1e-5 EI/(EA L^2) < 1e-10 of L.
  const StaticReport report = equilibrium(rod, Vec3::Zero(), force, 1e-5 * scale);
  EXPECT_TRUE(report.converged) << beams << " beams, load " << load << ", residual "
                                << report.residual / scale << " after " << report.iterations;
  const Vec3 tip = rod.poses(Configuration::current).back().position / length;
  return std::hypot(-tip.z() - w, 1 - tip.x() - u);
}

TEST(Elastica, ThirtyTwoBeamsAtEveryLoad) {
  const ReferenceTable table("a01_elastica_end_load.csv");
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const Real load = table.number(i, "PL2_over_EI");
    const Real w = table.number(i, "w_over_L"), u = table.number(i, "u_over_L");
    // Target: 1e-4 of L up to load 10, 5e-6 up to load 1, for the thread as it is, extension
    // included.
    const Real limit = load <= 1 ? 5e-6 : 1e-4;
    EXPECT_LT(tip_error(nylon(), 32, load, w, u), limit) << "load " << load;
  }
}

TEST(Elastica, ConvergesWithFourthOrder) {
  const ReferenceTable table("a01_elastica_end_load.csv");
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const Real load = table.number(i, "PL2_over_EI");
    if (load != 1 && load != 10) continue;
    const Real w = table.number(i, "w_over_L"), u = table.number(i, "u_over_L");
    const Real coarse = tip_error(inextensible(), 8, load, w, u);
    const Real fine = tip_error(inextensible(), 16, load, w, u);
    std::printf("load %g: 8 beams %.3e, 16 beams %.3e, order %.2f\n", load, coarse, fine,
                std::log2(coarse / fine));
    // Fourth order in theory; the issue asks for 1.9, a slip to second order must not pass.
    EXPECT_GT(std::log2(coarse / fine), 3.5) << "load " << load;
  }
}

}  // namespace
}  // namespace sutura::thread
