#include "energy_probe.h"

namespace sutura::output {

void EnergyProbe::describe(Describe<EnergyProbe>& d) {
  using T = EnergyProbe;
  d.summary(
      "Reads the energy of one body, the work done on it, and what the balance of both lacks.");
  d.theory(
      "Total energy is kinetic plus elastic energy plus that of the weight, *-m g . c* with the "
      "centre of mass *c*. The work of a step is each force at its end times the motion of the "
      "step, for loads (ThreadLoad, TissueLoad), holds (Grasper, a moving Attach) and constraint "
      "rows (contact, friction, cutting, ...). What of it is not found in the energy again is "
      "`lost`: to damping, and to implicit Euler, which takes energy from all that moves. A body "
      "that turns by an angle in a step moves along the chord; that makes work and loss uncertain "
      "by the square of the angle. Where a body softens as it moves, as a thread that buckles, the "
      "force at the end of a step is less than on the way, and `lost` may fall below zero; that is "
      "of first order in the step.\n\n"
      "Work, change and loss are counted from the start of the simulation. For two bodies that "
      "touch, the sum of both `work_of_constraints` is what the rows between them took: with a "
      "minus, the energy that friction, puncture and cutting dissipated, and that which the "
      "compliance of their laws stores.");
  d.link("body", &T::body_, "The thread or tissue.");
  d.output("energy", "J", "Kinetic plus elastic energy.",
           [](const T& e) -> Real { return e.body_->energy(); });
  d.output("potential", "J", "Energy of the weight, zero at the origin.",
           [](const T& e) { return e.potential(); });
  d.output("total", "J", "Sum of both.", [](const T& e) { return e.total(); });
  d.output("change", "J", "Total energy now less that before the first step.",
           [](const T& e) { return e.change(); });
  d.output("work_of_loads", "J", "Work of the loads on the body.",
           [](const T& e) { return e.report_->work.loads; });
  d.output("work_of_holds", "J", "Work of the holds and moving supports on the body.",
           [](const T& e) { return e.report_->work.holds; });
  d.output("work_of_constraints", "J", "Work of the constraint forces on the body.",
           [](const T& e) { return e.report_->work.constraints; });
  d.output("lost", "J", "Work of all three less the change of the total energy.", [](const T& e) {
    const Work& w = e.report_->work;
    return w.loads + w.holds + w.constraints - e.change();
  });
}

void EnergyProbe::begin(const Simulation& simulation) {
  for (std::size_t i = 0; i < simulation.bodies().size(); ++i)
    if (simulation.bodies()[i].body == body_.get()) report_ = &simulation.report().bodies[i];
  total_before_ = total();
}

}  // namespace sutura::output
