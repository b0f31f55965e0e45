#include "energy_probe.h"

namespace sutura::output {

void EnergyProbe::describe(Describe<EnergyProbe>& d) {
  using T = EnergyProbe;
  d.summary("Reads the energy of one body, with and without that of its weight.");
  d.theory(
      "Total energy is kinetic plus elastic energy plus that of the weight, *-m g . c* with the "
      "centre of mass *c*. What tools, loads and constraints do to the body changes it; what is "
      "lost beyond that went into friction, damping and the time integration (implicit Euler "
      "takes energy and never gives any).");
  d.link("body", &T::body_, "The thread or tissue.");
  d.output("energy", "J", "Kinetic plus elastic energy.",
           [](const T& e) -> Real { return e.body_->energy(); });
  d.output("potential", "J", "Energy of the weight, zero at the origin.",
           [](const T& e) { return e.potential(); });
  d.output("total", "J", "Sum of both.", [](const T& e) { return e.total(); });
  d.output("change", "J", "Total energy now less that at the start of the recording.",
           [](const T& e) -> Real { return e.at_start_ ? e.total() - *e.at_start_ : 0; });
}

}  // namespace sutura::output
