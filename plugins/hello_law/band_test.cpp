// The law against its definition, the component against the weight of what hangs on it.
#include <gtest/gtest.h>

#include <numbers>

#include "band_law.h"
#include "sutura/simulation.h"

using namespace sutura;

// Whatever W and d: the answer lies on the graph of the law.
TEST(BandLaw, AnswersLieOnItsGraph) {
  const BandLaw::Params p{.stiffness = 20, .limit = 0.5};
  for (const Real w : {1e-3, 0.05, 2.0}) {
    for (const Real free : {-3.0, -0.03, -0.01, 0.0, 0.01}) {
      Mode mode = 7;
      BlockVector<1> lambda(-1);
      BandLaw::project(BlockMatrix<1>(w), BlockVector<1>(free), p, mode, lambda);
      const Real delta = w * lambda[0] + free;
      const Real rounding = 1e-15 * (1 + std::abs(free));
      if (mode == BandLaw::slack) {
        EXPECT_EQ(lambda[0], 0);
        EXPECT_GE(delta, 0);
      } else if (mode == BandLaw::taut) {
        EXPECT_NEAR(delta, -lambda[0] / p.stiffness, rounding);
        EXPECT_TRUE(lambda[0] > 0 && lambda[0] < p.limit);
      } else {
        EXPECT_EQ(mode, BandLaw::yielding);
        EXPECT_EQ(lambda[0], p.limit);
        EXPECT_LE(delta, -p.limit / p.stiffness + rounding);
      }
    }
  }
}

static std::unique_ptr<Simulation> simulate(Real seconds, const std::string& limit) {
  Registry registry;
  enrol_builtin(registry);
  Diagnostics diagnostics;
  auto scene =
      load_scene(SCENE, registry, diagnostics,
                 {.plugin_directories = {PLUGIN_DIR}, .overrides = {{"/band.limit", limit}}});
  auto simulation = scene ? Simulation::compile(std::move(scene), ".", diagnostics) : nullptr;
  for (const Diagnostic& d : diagnostics.all()) ADD_FAILURE() << d.text();
  while (simulation && simulation->time() < seconds - 1e-6) simulation->step();
  return simulation;
}

static OutputValue output(const Simulation& simulation, const std::string& name) {
  const Component& band = *simulation.scene().find("/band");
  for (const OutputInfo& o : band.info().outputs) {
    if (o.name == name) return o.read(band);
  }
  return std::string("no output " + name);
}

// 4-0 polypropylene, 100 mm, by hand.
static const Real mass = 910 * std::numbers::pi * 0.0875e-3 * 0.0875e-3 * 0.1;
static const Real weight = mass * 9.81;

TEST(Band, CarriesTheWeightAtRest) {
  const auto simulation = simulate(1, "1 N");
  ASSERT_TRUE(simulation);
  EXPECT_EQ(std::get<std::string>(output(*simulation, "state")), "taut");
  // Implicit Euler damps the bounce (150 rad/s at 10 ms) to nothing within a second.
  EXPECT_NEAR(std::get<Real>(output(*simulation, "tension")), weight, 1e-3 * weight);
}

TEST(Band, YieldsAtItsLimit) {
  const Real seconds = 0.1;
  const auto simulation = simulate(seconds, "5 uN");
  ASSERT_TRUE(simulation);
  EXPECT_EQ(std::get<std::string>(output(*simulation, "state")), "yielding");
  EXPECT_EQ(std::get<Real>(output(*simulation, "tension")), 5e-6);
  // Momentum is the time integral of the forces. The band is taut, not yet yielding, during the
  // first step at most, in which it gives no more than its limit: 5e-6 N for 10 ms.
  const Real expected = (5e-6 - weight) * seconds;
  EXPECT_NEAR(simulation->bodies()[0].body->momentum().z(), expected, 5e-6 * 0.01);
}
