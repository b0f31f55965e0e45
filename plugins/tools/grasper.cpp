#include "grasper.h"

#include "sutura/archive.h"
#include "sutura/geometry/poses.h"
#include "sutura/units.h"

namespace sutura::tools {
void Grasper::describe(Describe<Grasper>& d) {
  d.summary(
      "Jaws that close on one section of a needle or thread at stated times and carry it along a "
      "track until they let go. The section is named by its abscissa; Forceps take what is "
      "between them.");
  d.theory(
      "When the jaws close, at the time of grasp (a step is divided there), the "
      "pose of the section relative to the tool is recorded, so nothing jumps. While they are "
      "closed the section is tied to *tool pose at the end of the step* times *that relative "
      "pose* by the implicit spring of CurveBody::set_hold: six stiffnesses, three in "
      "translation and three in rotation, of which roll counts whole turns. The force read out is "
      "what this "
      "spring applied to the curve over the step.");
  d.link("body", &Grasper::body_, "The needle and thread.");
  d.link("track", &Grasper::track_, "The motion of the tool.");
  d.attribute("at", &Grasper::at_, "m", between(0, 1e5),
              "Abscissa of the section that the jaws hold, from the needle tip.");
  d.attribute("stiffness", &Grasper::stiffness_, "N/m", between(1e-15, 1e12),
              "Of the grip, in translation.");
  d.attribute("rotation_stiffness", &Grasper::rotation_stiffness_, "N m/rad", between(0, 1e12),
              "Of the grip, in rotation; 0 lets the section turn in the jaws.");
  describe_times(d,
                 "Time in which the section is drawn from where it was taken to the tool's own "
                 "place, where the track leads the point 0 0 0; 0: it stays where it was taken.");
  d.output("force", "N", "Force of the jaws on the curve, at the end of the last step.",
           [](const Grasper& g) -> Vec3 { return g.wrench().force; });
  d.output("moment", "N m", "Moment of the jaws on the curve, about the held section.",
           [](const Grasper& g) -> Vec3 { return g.wrench().moment; });
  d.output("target", "m", "Where the jaws want the section; where they let go while they are open.",
           [](const Grasper& g) -> Vec3 { return g.target_.position; });
}

void Grasper::initialise(Setup& setup) {
  if (at_ > body_->length() * (1 + 1e-9)) {
    setup.error(*this, "'at' is " + format_real(at_) +
                           " m; expected an abscissa on 'body', which is " +
                           format_real(body_->length()) + " m long");
    return;
  }
  if (const std::string wrong = plan(); !wrong.empty()) {
    setup.error(*this, wrong);
    return;
  }
  hold_ = body_->add_hold(at_);
}

void Grasper::ready(Setup&) {
  target_ = body_->frame(at_, Configuration::current);
}

void Grasper::archive(Archive& a) {
  archive_jaws(a);
  a("grip", grip_);
  a("target", target_);
}

void Grasper::drive(const StepContext& context) {
  const bool changed = update(context);
  if (!holding()) {
    if (changed) body_->release_hold(hold_);
    return;
  }
  if (changed) {
    const Pose tool = track_->start_pose(), at = body_->frame(at_, Configuration::current);
    grip_ = {seen_from(tool, at.position), (tool.rotation.conjugate() * at.rotation).normalized()};
  }
  Pose grip = grip_;
  grip.position *= still_open(context);
  target_ = compose(track_->pose(), grip);
  body_->set_hold(hold_, target_, {stiffness_, rotation_stiffness_});
}

}  // namespace sutura::tools
