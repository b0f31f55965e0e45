#include "thread_probe.h"

#include "sutura/units.h"

namespace sutura::thread {

void ThreadProbe::describe(Describe<ThreadProbe>& d) {
  using T = ThreadProbe;
  d.summary("Reads one section of a needle or thread: where it is, and what it bears.");
  d.theory(
      "Tension, curvature and twist are those of the beam in which the section lies. The tension "
      "is *EA eps*, and what its viscosity (damping_stiffness) and an Elongation bear besides. "
      "Curvature and twist are the angle between its end tangents and the angle between its end "
      "sections about the tangent, each over its length. The force is the derivative of the "
      "elastic energy of the beam by the vector from its one end to the other, and the rest of the "
      "tension along it. With `EI` and `GJ` of the section they give the moments.");
  d.link("thread", &T::thread_, "The needle and thread.");
  d.attribute("at", &T::at_, "m", at_least(0), "Abscissa of the section, from the needle tip.")
      .required();
  d.output("position", "m", "Where the section is.", [](const T& p) { return p.position(); });
  d.output("displacement", "m", "How far it is from where it lies in the shape at rest.",
           [](const T& p) -> Vec3 {
             return p.position() - p.thread_->point(p.at_, Configuration::rest);
           });
  d.output("tangent", "1", "Direction of the thread, towards its end.",
           [](const T& p) { return p.thread_->tangent(p.at_, Configuration::current); });
  d.output("normal", "1", "A direction across the thread that turns with its material.",
           [](const T& p) -> Vec3 {
             return p.thread_->frame(p.at_, Configuration::current).rotation * Vec3::UnitY();
           });
  d.output("tension", "N", "Axial force, positive where the thread is taut.",
           [](const T& p) { return p.thread_->section_state(p.at_).tension; });
  d.output("force", "N",
           "Force with which what follows draws what comes before: the tension, and what the bent "
           "thread bears across itself.",
           [](const T& p) { return p.thread_->section_state(p.at_).force; });
  d.output("curvature", "1/m", "Curvature.",
           [](const T& p) { return p.thread_->section_state(p.at_).curvature; });
  d.output("twist", "rad/m", "Twist per length, beyond that at rest.",
           [](const T& p) { return p.thread_->section_state(p.at_).twist; });
}

void ThreadProbe::initialise(Setup& setup) {
  if (at_ > thread_->length() * (1 + 1e-9))
    setup.error(*this, "'at' is " + format_real(at_) + " m, but the thread is " +
                           format_real(thread_->length()) + " m long");
}

}  // namespace sutura::thread
