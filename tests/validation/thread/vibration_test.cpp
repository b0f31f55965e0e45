// a07a frequencies; a07b, a07c decay of implicit Euler.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "reference_table.h"
#include "unit/thread/divided_step.h"
#include "unit/thread/rod_builder.h"

namespace sutura::thread {
namespace {

/// Bending in the x-z plane: dofs z and spin about y of every node.
struct PlaneBending {
  MatX K, M;
  std::vector<Index> dofs;  ///< in the rod
  PlaneBending(const Rod& rod, bool z_first, bool spin_first, bool z_last, bool spin_last) {
    const Index n = rod.nodes();
    MatX k = MatX::Zero(6 * n, 6 * n), m = k;
    ElementState s;
    Mat9 h;
    for (Index e = 0; e < rod.beams(); ++e) {
      rod.element_state(e, s);
      hessian(rod.element(e), s, h);
      k.block<12, 12>(6 * e, 6 * e) += expand(h);
      m.block<12, 12>(6 * e, 6 * e) += mass_matrix(ElementMass(rod.element(e)), s.e, s.ta, s.tb);
    }
    for (Index i = 0; i < n; ++i) {
      const bool first = i == 0, last = i == n - 1;
      if (!(first && z_first) && !(last && z_last)) dofs.push_back(6 * i + 2);
      if (!(first && spin_first) && !(last && spin_last)) dofs.push_back(6 * i + 4);
    }
    K = k(dofs, dofs);
    M = m(dofs, dofs);
  }
};

TEST(Vibration, FrequenciesOfTenBeams) {
  const ReferenceTable table("a07a_beam_frequencies.csv");
  const Section s = nylon();
  const Real length = 0.1;  // L/d = 333: rotary inertia and shear below 1e-4
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const std::string ends = table.text(i, "ends");
    const int mode = static_cast<int>(table.number(i, "mode"));
    if (mode > 3) continue;
    Rod rod;
    rod.build(straight_layout(length, 10, s));
    const bool clamped = ends.starts_with("clamped");
    const bool to_free = ends.ends_with("free"), to_clamp = ends.ends_with("-clamped");
    const PlaneBending bending(rod, true, clamped, !to_free, to_clamp);
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> eigen(bending.K, bending.M);
    const Real unit = std::sqrt(s.bending_stiffness() / (s.density * s.area())) / (length * length);
    const Real expected = table.number(i, "w*sqrt(rho A L^4/EI)");
    // Asked: 1 %. Consistent mass on 10 cubic beams: (beta L/10)^4/720 = 2e-3 at beta L = 10.2,
    // half of it in frequency.
    EXPECT_NEAR(std::sqrt(eigen.eigenvalues()[mode - 1]) / unit, expected, 2e-3 * expected)
        << ends << ", mode " << mode;
  }
}

/// |l| and angle per step of a mode started at small amplitude, from four successive steps of the
/// rod.
struct Decay {
  Real size, angle;
  Decay(Rod& rod, const RodDamping& damping, Real h, int mode) {
    const PlaneBending bending(rod, true, true, false, false);
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> eigen(bending.K, bending.M);
    const VecX shape = eigen.eigenvectors().col(mode - 1);
    const Real amplitude = 1e-7 / shape.cwiseAbs().maxCoeff();  // 0.1 um or urad: linear
    for (std::size_t i = 0; i < bending.dofs.size(); ++i) {
      Pose& p = rod.poses()[static_cast<std::size_t>(bending.dofs[i] / 6)];
      if (bending.dofs[i] % 6 == 2)
        p.position.z() += amplitude * shape[i];
      else
        p.rotation = rotated(p.rotation, Vec3(0, amplitude * shape[i], 0));
    }
    const VecX test = bending.M * shape;
    RodStep step(rod);
    step.damping = damping;
    Real q[4];
    for (Real& value : q) {
      value = 0;
      for (std::size_t i = 0; i < bending.dofs.size(); ++i) {
        const Pose& p =
            rod.poses(Configuration::current)[static_cast<std::size_t>(bending.dofs[i] / 6)];
        value += test[static_cast<Index>(i)] *
                 (bending.dofs[i] % 6 == 2 ? p.position.z()
                                           : rotation_between(Quat::Identity(), p.rotation).y());
      }
      EXPECT_GT(step.advance(rod, h, Vec3::Zero(), VecX::Zero(rod.dofs()), well_balanced), 0);
    }
    // q_{n+2} - a q_{n+1} + b q_n = 0 with a = 2 Re l, b = |l|^2.
    const Real det = q[1] * q[1] - q[0] * q[2];
    const Real b = (q[2] * q[2] - q[1] * q[3]) / det;
    const Real a = (q[1] * q[2] - q[0] * q[3]) / det;
    size = std::sqrt(b);
    angle = std::acos(std::min(1., a / (2 * size)));
  }
};

TEST(Vibration, ImplicitEulerDecaysAsPredicted) {
  const ReferenceTable table("a07b_thread_implicit_euler.csv");
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const int mode = static_cast<int>(table.number(i, "mode"));
    if (mode > 2) continue;
    Rod rod;
    rod.build(straight_layout(0.05, 20, nylon()));
    rod.clamp(0);
    const Real h = table.number(i, "h s");
    const Decay d(rod, {}, h, mode);
    // Asked: 1 %.
    EXPECT_NEAR(d.size, table.number(i, "amplification per step"),
                0.01 * table.number(i, "amplification per step"))
        << "mode " << mode << ", h " << h;
    EXPECT_NEAR(d.angle / (2 * std::numbers::pi * h), table.number(i, "f apparent Hz"),
                0.01 * table.number(i, "f apparent Hz"))
        << "mode " << mode << ", h " << h;
  }
}

TEST(Vibration, RayleighDampingAsPredicted) {
  // |l|^2 = 1/(1 + c h + w^2 h^2), c = alpha + beta w^2; first mode of thread N, 50 mm.
  const Real w = 2 * std::numbers::pi * 22.23589993;
  for (const Real h : {1e-3, 5e-3, 20e-3})
    for (const auto& [alpha, beta] :
         {std::pair{0., 2e-3}, std::pair{30., 0.}, std::pair{10., 1e-3}}) {
      Rod rod;
      rod.build(straight_layout(0.05, 20, nylon()));
      rod.clamp(0);
      const Decay d(rod, {.mass = alpha, .stiffness = beta}, h, 1);
      const Real expected = 1 / std::sqrt(1 + (alpha + beta * w * w) * h + w * w * h * h);
      EXPECT_NEAR(d.size, expected, 0.01 * expected) << h << ' ' << alpha << ' ' << beta;
    }
}

}  // namespace
}  // namespace sutura::thread
