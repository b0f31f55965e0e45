// A scene of the real suturing components between a rigid needle and a layered slab on a spring.
#pragma once

#include <gtest/gtest.h>

#include <iomanip>
#include <memory>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "slab_world.h"

namespace sutura::testing {

struct SlabScene {
  Real dt = 10e-3;                                 ///< s
  Real stiffness = 300;                            ///< of the spring, N/m
  Real drag = 20;                                  ///< friction per length of needle inside, N/m
  std::vector<Real> tops{0}, punctures{}, cuts{};  ///< per layer: depth (m), fp and fc (N)
  std::vector<Real> turns{};                       ///< travel at the turns of the needle (m)
  Real speed = 10e-3;                              ///< m/s
  std::string solver{};                            ///< XML of a solver component, or none

  /// The registry must outlive the simulation.
  std::unique_ptr<Simulation> compile(Registry& registry) const {
    enrol_slab_world(registry);
    Diagnostics diagnostics;
    auto scene = load_scene_text(xml(), "slab", ".", registry, diagnostics);
    auto made = scene ? Simulation::compile(std::move(scene), ".", diagnostics) : nullptr;
    for (const Diagnostic& d : diagnostics.all()) ADD_FAILURE() << d.text();
    return made;
  }

 private:
  static std::string list(const std::vector<Real>& values, const std::string& unit = "") {
    std::ostringstream out;
    out << '"' << std::setprecision(12);
    for (const Real v : values) out << v << ' ';
    return out.str() + unit + '"';
  }
  std::string xml() const {
    std::vector<Real> times{0}, tags, under(tops.begin() + 1, tops.end());
    for (std::size_t i = 1; i < turns.size(); ++i) {
      times.push_back(times.back() + std::abs(turns[i] - turns[i - 1]) / speed);
    }
    for (std::size_t i = 0; i < tops.size(); ++i) tags.push_back(Real(i + 1));
    const Real pressure = drag / (std::numbers::pi * 0.5e-3);  // with friction coefficient 1
    return "<sutura version=\"1\" gravity=\"0 0 0\" dt=" + list({dt}, "s") + ">" + solver +
           "<RigidNeedle radius=\"0.25 mm\" times=" + list(times, "s") +
           " travel=" + list(turns, "m") + "/><SpringSlab stiffness=" + list({stiffness}, "N/m") +
           (under.empty() ? "" : " layers=" + list(under, "m")) +
           "/><SuturePath spacing=\"0.5 mm\"/><Cutting regions=" + list(tags) +
           " region_thresholds=" + list(cuts, "N") +
           "/><PathFriction coefficient=\"1\" pressure=" + list({pressure}, "Pa") +
           "/><Puncture regions=" + list(tags) + " region_thresholds=" + list(punctures, "N") +
           "/></sutura>";
  }
};

}  // namespace sutura::testing
