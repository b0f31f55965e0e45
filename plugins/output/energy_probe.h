// EnergyProbe: the energy of a body, with that of its weight, and how it has changed.
#pragma once

#include <optional>

#include "sutura/archive.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"

namespace sutura::output {

class EnergyProbe : public Component, public Recorder {
 public:
  static void describe(Describe<EnergyProbe>& d);
  void initialise(Setup& setup) override { gravity_ = setup.gravity; }

  /// Notes the energy before the first step, once all bodies have settled.
  std::string start(const Simulation&) override {
    at_start_ = total();
    return {};
  }
  std::string resume(const Simulation& simulation) override {
    return at_start_ ? std::string() : start(simulation);
  }
  void archive(Archive& a) override {
    bool known = at_start_.has_value();
    Real energy = at_start_.value_or(0);
    a("known", known);
    a("at_start", energy);
    if (a.restoring()) at_start_ = known ? std::optional<Real>(energy) : std::nullopt;
  }
  std::string record(const Simulation&, const StepReport&) override { return {}; }
  std::string finish(const Simulation&) override { return {}; }

 private:
  Real potential() const {
    return gravity_.isZero(0) ? 0 : -body_->mass() * gravity_.dot(body_->centre_of_mass());
  }
  Real total() const { return body_->energy() + potential(); }

  Link<Body> body_;
  Vec3 gravity_ = Vec3::Zero();
  std::optional<Real> at_start_;
};

}  // namespace sutura::output
