// A needle that meets the surface at 30, 45 and 60 degrees: a rigid straight needle driven along
// its own axis into a slab on an isotropic spring K. With theta the angle between needle and
// surface, s the travel since contact, mu the friction of the tip:
//
//   normal force      N = K s sin(theta)                     the surface gives way at N = fp, s =
//   fp / (K sin(theta)) tangential force  min(cot(theta), mu) N                  the tip sticks
//   where cot(theta) <= mu slide of the tip  s (cos(theta) - mu sin(theta)), or 0   ahead, along
//   the surface
//
// Once through, the slab slides along the needle only: what the spring pulls across it stays as it
// was at the puncture, fp (cos(theta) - mu sin(theta)), or 0 if the tip stuck.
#include <gtest/gtest.h>

#include <cmath>
#include <iomanip>
#include <numbers>
#include <sstream>

#include "puncture_law.h"
#include "slab_world.h"

namespace sutura::testing {
namespace {

/// Rigid and straight as RigidNeedle, aslant in the plane y = 0: it advances along (cos, 0, -sin)
/// of its angle.
struct ObliqueNeedle : RigidNeedle {
  Real angle = 0;  // rad
  static void describe(Describe<ObliqueNeedle>& d) {
    d.summary("Rigid straight needle at an angle.");
    d.attribute("times", static_cast<std::vector<Real> ObliqueNeedle::*>(&RigidNeedle::times), "s",
                at_least(0), "Times.");
    d.attribute("travel", static_cast<std::vector<Real> ObliqueNeedle::*>(&RigidNeedle::travel),
                "m", any(), "Travel then.");
    d.attribute("angle", &ObliqueNeedle::angle, "rad", above(0), "Angle to the surface.");
  }
  Vec3 ahead() const { return {std::cos(angle), 0, -std::sin(angle)}; }
  Vec3 point(Real s, Configuration c) const override {
    return ((c == Configuration::start     ? start_
             : c == Configuration::current ? now_
                                           : 0) -
            s) *
           ahead();
  }
  Vec3 tangent(Real, Configuration) const override { return -ahead(); }
  Pose frame(Real s, Configuration c) const override {
    return {point(s, c), shortest_rotation(Vec3::UnitX(), -ahead())};
  }
  Real closest_abscissa(const Vec3& p, Real, Real low, Real high, Configuration c) const override {
    return std::clamp(-ahead().dot(p - point(0, c)), low, high);
  }
};

constexpr Real K = 300, fp = 0.3, fc = 0.1;  // N/m, N, N
constexpr Real degree = std::numbers::pi / 180;
constexpr Real step_length = 0.02e-3;  // m

struct Oblique {
  Real angle, mu;
};

class ObliqueEntry : public ::testing::TestWithParam<Oblique> {
 protected:
  /// To `far`, and back.
  void compile(Real far = 5e-3) {
    const auto [angle, mu] = GetParam();
    const Real dt = 2e-3;
    std::ostringstream xml;
    xml << std::setprecision(17) << "<sutura version='1' gravity='0 0 0' dt='" << dt
        << "'><ObliqueNeedle angle='" << angle << "' times='0 " << far / step_length * dt << ' '
        << 2 * far / step_length * dt << "' travel='0 " << far << " 0'/><SpringSlab stiffness='"
        << K << "'/><SuturePath spacing='0.5 mm' wall_compliance='1e-9'/><Cutting threshold='" << fc
        << "'/><PathFriction coefficient='0'/><Puncture threshold='" << fp << "' friction='" << mu
        << "'/><GaussSeidel tolerance='1e-9'/></sutura>";
    enrol_slab_world(registry);
    registry.component<ObliqueNeedle>("ObliqueNeedle");
    Diagnostics diagnostics;
    auto scene = load_scene_text(xml.str(), "oblique", ".", registry, diagnostics);
    if (scene) simulation = Simulation::compile(std::move(scene), ".", diagnostics);
    for (const Diagnostic& d : diagnostics.all()) ADD_FAILURE() << d.text();
    ASSERT_TRUE(simulation);
  }
  const ConstraintBlock* puncture_block() const {
    for (const ConstraintBlock& b : simulation->problem().blocks)
      if (b.law == &law_operations<suturing::PunctureLaw>) return &b;
    return nullptr;
  }
  Registry registry;
  std::unique_ptr<Simulation> simulation;
};

TEST_P(ObliqueEntry, PressesAlongTheNormalAndEntersAlongItsAxis) {
  const auto [angle, mu] = GetParam();
  compile();
  const auto& needle = dynamic_cast<const ObliqueNeedle&>(*simulation->find("/oblique_needle"));
  const auto& slab = dynamic_cast<const SpringSlab&>(*simulation->find("/spring_slab"));
  const auto& path = dynamic_cast<const SuturePath&>(*simulation->find("/suture_path"));
  const Real sine = std::sin(angle), cosine = std::cos(angle);
  const bool sticks = cosine <= mu * sine;
  const Real tangential = std::min(cosine / sine, mu);  // per normal force
  const Real slide = sticks ? 0 : cosine - mu * sine;   // per travel
  const Real due = fp / (K * sine);                     // travel at the puncture
  const Vec3 across(sine, 0, cosine);

  bool open = false;
  for (Index i = 0; i < 250; ++i) {
    const StepReport& report = simulation->step();
    ASSERT_TRUE(report.solved) << i;
    const Real s = needle.now_;
    const bool was_open = open;
    const ConstraintBlock* block = puncture_block();
    open = open || (block && block->mode == suturing::PunctureLaw::penetrated);
    const Vec3 spring = -K * slab.u_;  // on the slab; the needle pushes it by as much
    // What is not static is the mass of the slab, m / (K dt^2) = 8e-4 of what changes in a step;
    // the solver is exact to 1e-9. A thousandth of the threshold covers both.
    const Real tolerance = 1e-3 * fp;
    if (!open) {
      ASSERT_TRUE(block);
      const Vec3 force = simulation->problem().block_force(*block);  // on the tip
      EXPECT_NEAR(force.z(), K * s * sine, tolerance) << "at " << s;
      EXPECT_NEAR(force.x(), -tangential * K * s * sine, tolerance) << "at " << s;
      EXPECT_NEAR(force.y(), 0, 1e-9);
      EXPECT_LT((spring - force).norm(), tolerance);
      EXPECT_LT(s, due + 1e-9) << "should have given way";
      // Where the tip is on the slab.
      const Vec3 material = needle.point(0, Configuration::current) - slab.u_;
      EXPECT_NEAR(material.x(), slide * s, tolerance / K);
      EXPECT_NEAR(material.z(), 0, 1e-9);
      continue;
    }
    if (!was_open) {
      EXPECT_GE(s, due - 1e-9);
      EXPECT_LT(s, due + step_length + 1e-9);
    }
    // The channel begins where the tip pressed, at the end of the step before or within the slide
    // of this one, and follows the axis.
    const auto& samples = path.channel().samples();
    ASSERT_FALSE(samples.empty());
    const Vec3 mouth(samples[0].at.weights[0], samples[0].at.weights[1], samples[0].at.weights[2]);
    EXPECT_NEAR(mouth.x(), slide * due, slide * step_length + tolerance / K);
    EXPECT_NEAR(mouth.y(), 0, 1e-9);
    EXPECT_NEAR(mouth.z(), 0, 1e-9);
    for (const PathSample& p : samples) {
      const Vec3 material(p.at.weights[0], p.at.weights[1], p.at.weights[2]);
      // The wall gives by 1e-9 1/Pa * 0.3 N / 0.5 mm = 6e-7 m.
      EXPECT_LT((material - mouth - p.depth * needle.ahead()).norm(), 1e-6)
          << "at depth " << p.depth;
    }
    // Along: the tip cuts with fc once the slab has come back to meet it; across: what the puncture
    // left.
    if (s < due + 1e-3) continue;
    EXPECT_NEAR(spring.dot(-needle.ahead()), fc, tolerance);
    // A step before the puncture or at it: the slide of one step.
    EXPECT_NEAR(spring.dot(across), fp * slide, K * slide * sine * step_length + tolerance);
    EXPECT_NEAR(spring.y(), 0, 1e-9);
  }
  EXPECT_TRUE(open);
}

/// Turned back before the surface gives way, the tip sticks until the spring has swung from one
/// limit of friction to the other, and slides back: -mu K s sin(theta) <= f <= mu K s sin(theta),
/// with f as far from its value at the turn as the tip has gone along the surface, if that is
/// within.
TEST_P(ObliqueEntry, FrictionTurnsWithTheTip) {
  const auto [angle, mu] = GetParam();
  const Real sine = std::sin(angle), cosine = std::cos(angle);
  const Real turn = 20 * step_length;
  ASSERT_LT(turn, fp / (K * sine));
  compile(turn);
  const auto& needle = dynamic_cast<const ObliqueNeedle&>(*simulation->find("/oblique_needle"));
  const Real at_turn = K * turn * std::min(cosine, mu * sine);
  for (Index i = 0; i < 39; ++i) {
    ASSERT_TRUE(simulation->step().solved) << i;
    const Real s = needle.now_, limit = mu * K * s * sine;
    const Real stuck = i < 20 ? K * s * cosine : at_turn - K * (turn - s) * cosine;
    const ConstraintBlock* block = puncture_block();
    ASSERT_TRUE(block);
    const Vec3 force = simulation->problem().block_force(*block);  // on the tip
    EXPECT_NEAR(force.z(), K * s * sine, 1e-3 * fp) << i;
    EXPECT_NEAR(-force.x(), std::clamp(stuck, -limit, limit), 1e-3 * fp) << i;
  }
}

// Sticking needs mu >= cot(theta): 1.73, 1 and 0.58.
INSTANTIATE_TEST_SUITE_P(Angles, ObliqueEntry,
                         ::testing::Values(Oblique{30 * degree, 2}, Oblique{30 * degree, 0.3},
                                           Oblique{30 * degree, 0}, Oblique{45 * degree, 1.2},
                                           Oblique{45 * degree, 0.3}, Oblique{45 * degree, 0},
                                           Oblique{60 * degree, 0.8}, Oblique{60 * degree, 0.3},
                                           Oblique{60 * degree, 0}));

}  // namespace
}  // namespace sutura::testing
