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

// The scene of this folder, run for a while.
class Band : public testing::Test {
 protected:
  void run(Real seconds, const std::string& limit) {
    enrol_builtin(registry_);
    Diagnostics diagnostics;
    auto scene =
        load_scene(SCENE, registry_, diagnostics,
                   {.plugin_directories = {PLUGIN_DIR}, .overrides = {{"/band.limit", limit}}});
    if (scene) simulation_ = Simulation::compile(std::move(scene), ".", diagnostics);
    for (const Diagnostic& d : diagnostics.all()) ADD_FAILURE() << d.text();
    ASSERT_TRUE(simulation_);
    while (simulation_->time() < seconds - 1e-6) simulation_->step();
  }
  OutputValue output(const std::string& name) const {
    const Component& band = *simulation_->find("/band");
    for (const OutputInfo& o : band.info().outputs) {
      if (o.name == name) return o.read(band);
    }
    return "no output " + name;
  }
  const Body& thread() const { return *simulation_->bodies()[0].body; }

  Registry registry_;  // before what is made from it: it must live longer
  std::unique_ptr<Simulation> simulation_;
};

// 4-0 polypropylene, 100 mm, by hand.
static const Real mass = 910 * std::numbers::pi * 0.0875e-3 * 0.0875e-3 * 0.1;
static const Real weight = mass * 9.81;

TEST_F(Band, CarriesTheWeightAtRest) {
  run(1, "1 N");
  EXPECT_EQ(output("state"), OutputValue("taut"));
  // Implicit Euler damps the bounce (150 rad/s at 10 ms) to nothing within a second.
  EXPECT_NEAR(std::get<Real>(output("tension")), weight, 1e-3 * weight);
}

TEST_F(Band, YieldsAtItsLimit) {
  const Real seconds = 0.1;
  run(seconds, "5 uN");
  EXPECT_EQ(output("state"), OutputValue("yielding"));
  EXPECT_EQ(std::get<Real>(output("tension")), 5e-6);
  // Momentum is the time integral of the forces. The band is taut, not yet yielding, during the
  // first step at most, in which it gives no more than its limit: 5e-6 N for 10 ms.
  const Real expected = (5e-6 - weight) * seconds;
  EXPECT_NEAR(thread().momentum().z(), expected, 5e-6 * 0.01);
}
