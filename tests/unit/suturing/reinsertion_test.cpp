// Three layers, in, half out, in again through the same channel, on, and out: force against
// displacement on the real components, for several steps and sweep counts, against a quasi-static
// model of its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "slab_scene.h"

namespace sutura::testing {
namespace {

struct Layer {
  Real top, puncture, cutting;  // m, N, N
};
constexpr Real K = 300, tau = 20;  // N/m, N/m
const std::vector<Layer> layers = {{0, 0.9, 0.3}, {4e-3, 0.7, 0.15}, {9e-3, 0.8, 0.4}};
// Where the needle goes, in metres of travel, at 10 mm/s.
const std::vector<Real> turns = {0, 16e-3, 4e-3, 19e-3, 0};

/// A needle at x pushes a slab on a spring: force F = K (x - a) with a the length inserted. In
/// equilibrium F lies between -tau a and the resistance to going on: friction in the channel, and
/// at its end the cutting force, or the puncture force of a layer that is not pierced yet. Advanced
/// by small moves, with no laws and no solver.
class QuasiStatic {
 public:
  Real move_to(Real x) {
    while (std::abs(x - x_) > 1e-15) {
      x_ += std::clamp(x - x_, -1e-6, 1e-6);
      settle();
    }
    return K * (x_ - a_);
  }

 private:
  void settle() {
    for (;;) {
      const Real force = K * (x_ - a_);
      if (a_ <= 0 && force <= 0) {  // out: the needle is not held from behind
        a_ = std::min(x_, 0.);
        return;
      }
      if (a_ < end_) {  // in the channel
        if (force > tau * a_)
          a_ = std::min(K * x_ / (K + tau), end_);
        else if (force < -tau * a_)
          a_ = std::max(K * x_ / (K - tau), 0.);
        if (a_ < end_) return;
        continue;
      }
      if (force < -tau * a_) {
        a_ = K * x_ / (K - tau);
        return;
      }
      const bool at_layer = pierced_ < layers.size() && end_ >= layers[pierced_].top - 1e-12;
      if (at_layer) {
        if (force < layers[pierced_].puncture + tau * a_) return;
        ++pierced_;
      }
      const Real fc = layers[pierced_ - 1].cutting;
      if (force <= fc + tau * a_) return;
      const Real next = pierced_ < layers.size() ? layers[pierced_].top : 1;
      a_ = end_ = std::min((K * x_ - fc) / (K + tau), next);
      if (end_ < next) return;
    }
  }

  Real x_ = 0, a_ = 0, end_ = 0;
  std::size_t pierced_ = 0;
};

void expect_the_curve(Real dt, const std::string& solver) {
  SlabScene scene{
      .dt = dt, .stiffness = K, .drag = tau, .tops = {}, .turns = turns, .solver = solver};
  for (const Layer& l : layers) {
    scene.tops.push_back(l.top);
    scene.punctures.push_back(l.puncture);
    scene.cuts.push_back(l.cutting);
  }
  Registry registry;
  const auto sim = scene.compile(registry);
  ASSERT_TRUE(sim);
  const auto& needle = dynamic_cast<const RigidNeedle&>(*sim->find("/rigid_needle"));
  const auto& slab = dynamic_cast<const SpringSlab&>(*sim->find("/spring_slab"));
  const Real total = needle.times.back();
  // The exact force at every quarter of a step, to know it around each step: an event falls on a
  // step, and 2 % of the peak (issue 4) are 0.065 mm of the spring.
  const Real allowed = 0.02 * 0.98;
  const Index around = 4 + Index(std::ceil(allowed / K / (scene.speed * dt / 4)));
  QuasiStatic exact;
  std::vector<Real> curve;
  for (Index i = 0; i <= 4 * Index(std::ceil(total / dt)) + around; ++i) {
    curve.push_back(exact.move_to(needle.at(Real(i) * dt / 4)));
  }
  for (Index i = 1; i <= Index(std::floor(total / dt)); ++i) {
    ASSERT_TRUE(sim->step().solved) << "step " << i;
    const Real force = -slab.stiffness * slab.u_.z();
    const auto [low, high] = std::minmax_element(curve.begin() + std::max<Index>(4 * i - around, 0),
                                                 curve.begin() + 4 * i + around + 1);
    EXPECT_GT(force, *low - allowed) << "at " << needle.now_ * 1e3 << " mm, step " << i;
    EXPECT_LT(force, *high + allowed) << "at " << needle.now_ * 1e3 << " mm, step " << i;
  }
}

class ThreeLayersByStep : public ::testing::TestWithParam<Real> {};
TEST_P(ThreeLayersByStep, InBackInAgainAndOut) {
  expect_the_curve(GetParam(), "");
}
INSTANTIATE_TEST_SUITE_P(Steps, ThreeLayersByStep, ::testing::Values(20e-3, 10e-3, 5e-3, 1e-3));

// The forces do not depend on how often the solver sweeps, once it has converged.
class ThreeLayersBySweeps : public ::testing::TestWithParam<std::string> {};
TEST_P(ThreeLayersBySweeps, InBackInAgainAndOut) {
  expect_the_curve(10e-3, GetParam());
}
INSTANTIATE_TEST_SUITE_P(Sweeps, ThreeLayersBySweeps,
                         ::testing::Values(R"(<GaussSeidel sweeps="20"/>)",
                                           R"(<GaussSeidel sweeps="2000"/>)",
                                           R"(<GaussSeidel sweeps="2000" acceleration="none"/>)"));

}  // namespace
}  // namespace sutura::testing
