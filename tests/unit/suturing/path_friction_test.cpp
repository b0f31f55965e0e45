// What resists in a channel: materials of needle and thread, and a pressure taken from the
// stiffness of each layer.
#include <gtest/gtest.h>

#include <numbers>
#include <sstream>

#include "slab_world.h"

namespace sutura::testing {
namespace {

/// The sum of kinetic resistances with 12 mm inside: unless told otherwise 4 mm of thread in the
/// first layer, 3 mm of thread and the 5 mm needle in the second.
Real resistance(const std::string& friction, Diagnostics& diagnostics,
                const std::string& slab = "layers='4 mm' youngs='20 60 kPa'",
                const std::string& spacing = "0.1 mm") {
  Registry registry;
  enrol_slab_world(registry);
  auto scene = load_scene_text(
      "<sutura version='1' gravity='0 0 0' dt='10 ms'><RigidNeedle radius='0.25 mm' swage='5 mm' "
      "times='0 1.2 s' "
      "travel='0 12 mm'/><SpringSlab stiffness='1e6 N/m' " +
          slab + "/><SuturePath spacing='" + spacing +
          "'/><Puncture threshold='0.1 N'/><PathFriction "
          "name='friction' " +
          friction + "/></sutura>",
      "friction", ".", registry, diagnostics);
  const auto sim = scene ? Simulation::compile(std::move(scene), ".", diagnostics) : nullptr;
  if (!sim) return 0;
  for (int i = 0; i < 130; ++i) sim->step();
  for (const OutputInfo& o : sim->find("/friction")->info().outputs)
    if (o.name == "limit") return std::get<Real>(o.read(*sim->find("/friction")));
  return 0;
}

constexpr Real girth = 2 * std::numbers::pi * 0.25e-3;
// A sample at the border of two layers or materials stands for 0.1 mm of one of them; forces of a
// newton move the slab by 1 um.
constexpr Real border = 0.1e-3 * girth;

TEST(PathFriction, NeedleAndThreadHaveAMaterialEach) {
  Diagnostics none;
  const Real p = 10e3;
  EXPECT_NEAR(resistance("coefficient='0.1' pressure='10 kPa' thread_material='braided'", none),
              girth * p * (0.1 * 5e-3 + 0.3 * 7e-3), border * p * 0.2);
  EXPECT_NEAR(
      resistance("coefficient='0.1' pressure='10 kPa' thread_material='monofilament'", none),
      girth * p * (0.1 * 5e-3 + 0.15 * 7e-3), border * p * 0.2);
  EXPECT_NEAR(resistance("coefficient='0.1' pressure='10 kPa'", none), girth * p * 0.1 * 12e-3,
              border * p * 0.2);
  EXPECT_TRUE(none.ok());
}

TEST(PathFriction, PressureFromTheStiffnessOfEachLayer) {
  Diagnostics none;
  // Sneddon's slit: p = E / (pi (1 - nu^2)), nu = 0.45.
  const Real soft = 20e3 / (std::numbers::pi * (1 - 0.45 * 0.45)), stiff = 3 * soft;
  EXPECT_NEAR(
      resistance("coefficient='0.1' pressure_from='tissue' thread_material='braided'", none),
      girth * (0.1 * stiff * 5e-3 + 0.3 * (stiff * 3e-3 + soft * 4e-3)), border * stiff * 0.3);
  EXPECT_TRUE(none.ok());
}

// Away from the tip each border is told to a sixteenth of a spacing. What the samples themselves
// see of the thin layer, 1 mm or nothing, is off by 0.4 mm or more.
TEST(PathFriction, ALayerThinnerThanTheSpacingOfSamples) {
  const Real soft = 20e3 / (std::numbers::pi * (1 - 0.45 * 0.45)), stiff = 5 * soft;
  for (const Real top : {3.6, 4.0, 4.3, 4.5}) {
    Diagnostics none;
    std::ostringstream slab;
    slab << "youngs='20 100 20 kPa' layers='" << top << ' ' << top + 0.6 << " mm'";
    EXPECT_NEAR(resistance("coefficient='0.1' pressure_from='tissue'", none, slab.str(), "1 mm"),
                girth * 0.1 * (soft * 11.4e-3 + stiff * 0.6e-3),
                girth * 0.1 * (stiff - soft) * 0.125e-3)
        << top;
    EXPECT_TRUE(none.ok());
  }
}

TEST(PathFriction, ATissueThatDoesNotSayHowStiffItIs) {
  Diagnostics diagnostics;
  resistance("coefficient='0.1' pressure_from='tissue'", diagnostics, "");
  ASSERT_EQ(diagnostics.errors(), 1u);
  EXPECT_NE(diagnostics.all()[0].text().find("does not say how stiff it is"), std::string::npos);
}

}  // namespace
}  // namespace sutura::testing
