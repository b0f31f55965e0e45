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
  void archive(Archive& a) override;

  /// Notes energy and work before the first step, once all bodies have settled.
  std::string start(const Simulation& simulation) override;
  std::string resume(const Simulation& simulation) override;
  std::string record(const Simulation&, const StepReport&) override { return {}; }
  std::string finish(const Simulation&) override { return {}; }

 private:
  Real potential() const {
    return gravity_.isZero(0) ? 0 : -body_->mass() * gravity_.dot(body_->centre_of_mass());
  }
  Real total() const { return body_->energy() + potential(); }
  Real change() const { return is_recording_ ? total() - total_before_ : 0; }
  /// Since the start of the recording.
  Work work() const;
  void find(const Simulation& simulation);

  Link<Body> body_;
  Vec3 gravity_ = Vec3::Zero();
  const BodyReport* report_ = nullptr;  ///< of the body
  bool is_recording_ = false;
  Real total_before_ = 0;  ///< at the start of the recording (J)
  Work work_before_;
};

}  // namespace sutura::output
