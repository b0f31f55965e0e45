#include "puncture.h"

#include <algorithm>

#include "puncture_law.h"
#include "region_values.h"

namespace sutura {

void Puncture::describe(Describe<Puncture>& d) {
  d.summary(
      "Contact of the needle tip with the surface of a tissue, from outside (entry) and from inside (exit): frictional "
      "contact up to a force threshold; at the threshold the tip goes through and a channel begins or ends.");
  d.theory(
      "Paper, section 4.2: 0 <= delta _|_ lambda >= 0 while lambda < fp; 0 <= -delta _|_ fp - lambda >= 0 while lambda > 0, "
      "delta = n^T (tip - surface point). The puncture fires only on converged multipliers, all due ones at once, and the "
      "solve goes on with the law of the pierced state: bilateral across the needle, cutting along it.");
  d.link("path", &Puncture::path_, "The channel that begins and ends at the punctures.");
  d.link("cutting", &Puncture::cutting_, "Resistance once through; none without.").optional();
  d.attribute("threshold", &Puncture::threshold_, "N", above(0),
              "Puncture force fp on entry, where no region says otherwise.");
  d.attribute("exit_threshold", &Puncture::exit_threshold_, "N", above(0),
              "Puncture force from inside.");
  d.attribute("regions", &Puncture::regions_, "1", at_least(0),
              "Region tags of the tissue with an entry threshold of their own.");
  d.attribute("region_thresholds", &Puncture::region_thresholds_, "N", above(0),
              "One threshold per tag in `regions`.");
  d.attribute("friction", &Puncture::friction_, "1", at_least(0),
              "Coulomb coefficient of the tip on the surface before it goes through.");
  d.output("force", "N", "Force of the surface on the tip, along the normal.",
           [](const Puncture& p) { return p.force_; });
  d.output("peak_force", "N", "Largest force along the normal so far.",
           [](const Puncture& p) { return p.peak_force_; });
  d.output("punctures", "1", "Times the tip has gone through a surface.",
           [](const Puncture& p) { return Real(p.count_); });
  d.output("state", "", "Contact of the tip: free, pressing (from outside) or tenting (from inside).",
           [](const Puncture& p) -> std::string {
             if (p.side_ == Side::none || p.force_ <= 0) return "free";
             return p.side_ == Side::outside ? "pressing" : "tenting";
           });
}

void Puncture::initialise(Setup& setup) {
  source_id_ = setup.source_id;
  check_region_values(*this, setup, regions_, region_thresholds_, "region_thresholds");
  if (path_->tissue().locate(path_->thread().point(0, Configuration::current),
                             Configuration::current)) {
    setup.error(*this, "the needle tip starts inside the tissue; move the needle or the tissue");
  }
}

void Puncture::detect(const StepContext&) {
  side_ = Side::none;
  if (!path_->channel().tip_inside()) {
    find_entry();
  } else if (path_->channel().tip_at_end()) {
    find_exit();
  }
}

void Puncture::find_entry() {
  const CurveBody& thread = path_->thread();
  const Vec3 tip = thread.point(0, Configuration::current);
  const Real motion = (thread.point(0, Configuration::free) - tip).norm();
  const auto hit =
      path_->tissue().closest_surface(tip, motion + path_->spacing(), Configuration::current);
  if (!hit) return;
  if (path_->channel().mouth_near(tip, 2 * thread.radius(0) + path_->spacing())) return;
  touched_ = *hit;
  side_ = Side::outside;
}

void Puncture::find_exit() {
  const CurveBody& thread = path_->thread();
  const SolidBody& tissue = path_->tissue();
  const Vec3 tip = thread.point(0, Configuration::current);
  const Vec3 forward = -thread.tangent(0, Configuration::current);
  const Real motion = (thread.point(0, Configuration::free) - tip).norm();
  const Real reach = motion + path_->spacing();
  auto hit = tissue.crossing(tip, tip + reach * forward, Configuration::current);
  // A tip that tents the surface may sit on it, on either side by rounding.
  if (!hit) hit = tissue.closest_surface(tip, 0.1 * path_->spacing(), Configuration::current);
  if (!hit || hit->normal.dot(forward) <= 0) return;
  touched_ = *hit;
  side_ = Side::inside;
  const Real to_go = touched_.normal.dot(touched_.position - tip);
  path_->set_tip_blocked(to_go < 0.05 * path_->spacing());
}

void Puncture::build(const StepContext&, ConstraintBuilder& builder) {
  block_ = {};
  force_ = 0;
  if (side_ == Side::none) return;
  const CurveBody& thread = path_->thread();
  const SolidBody& tissue = path_->tissue();
  const bool entry = side_ == Side::outside;
  const Vec3 tip = thread.point(0, Configuration::current);

  PunctureLaw::Params params;
  params.normal = entry ? touched_.normal : Vec3(-touched_.normal);
  params.axis = -thread.tangent(0, Configuration::current);
  params.puncture_force = entry ? region_value(tissue.region(touched_.at), regions_,
                                               region_thresholds_, threshold_)
                                : exit_threshold_;
  params.cutting_force = entry && cutting_ ? cutting_->threshold(touched_.at) : 0;
  params.friction = friction_;

  const Vec3 free = thread.point(0, Configuration::free) -
                    tissue.position(touched_.at, Configuration::free);
  block_ = builder.add<PunctureLaw>(make_key(source_id_, entry ? 0 : 1), params,
                                    BlockVector<3>(free), PunctureLaw::pressing,
                                    {.force = params.puncture_force});
  const Eigen::Matrix<Real, Eigen::Dynamic, 3> world = Mat3::Identity();
  PointJacobian J;
  thread.jacobian(thread.embed(0), J);
  builder.couple(block_, thread, world, J, tip);
  tissue.jacobian(touched_.at, J);
  builder.couple(block_, tissue, -world, J, tip);
}

void Puncture::commit(const StepContext&, const SolvedBlocks& solved) {
  if (!block_.valid()) return;
  const Vec3 outward = side_ == Side::outside ? touched_.normal : Vec3(-touched_.normal);
  force_ = outward.dot(solved.force(block_));
  if (solved.mode(block_) != PunctureLaw::penetrated) {
    peak_force_ = std::max(peak_force_, force_);
    return;
  }
  ++count_;
  force_ = 0;
  Channel& channel = path_->channel();
  if (side_ == Side::outside) {
    channel.enter(touched_.at);
  } else if (channel.tip_inside()) {
    channel.leave(touched_.at);
  }
}

}  // namespace sutura
