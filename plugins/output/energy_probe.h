// EnergyProbe: the energy of a body with that of its weight, and the work that was done on it.
#pragma once

#include "sutura/archive.h"
#include "sutura/describe.h"
#include "sutura/simulation.h"

namespace sutura::output {

class EnergyProbe : public Component, public Recorder {
 public:
  static void describe(Describe<EnergyProbe>& d);
  void initialise(Setup& setup) override { gravity_ = setup.gravity; }
  void archive(Archive& a) override { a("total_before", total_before_); }

  /// Notes the energy before the first step, once all bodies have settled.
  void begin(const Simulation& simulation) override;
  std::string start(const Simulation&) override { return {}; }
  std::string record(const Simulation&, const StepReport&) override { return {}; }
  std::string finish(const Simulation&) override { return {}; }

 private:
  Real potential() const {
    return gravity_.isZero(0) ? 0 : -body_->mass() * gravity_.dot(body_->centre_of_mass());
  }
  Real total() const { return body_->energy() + potential(); }
  Real change() const { return total() - total_before_; }

  Link<Body> body_;
  Vec3 gravity_ = Vec3::Zero();
  const BodyReport* report_ = nullptr;
  Real total_before_ = 0;  ///< at the start (J)
};

}  // namespace sutura::output
