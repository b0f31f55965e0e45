#include "cutting.h"

#include <cmath>

#include "cutting_law.h"
#include "sutura/archive.h"

namespace sutura::suturing {

void Cutting::describe(Describe<Cutting>& d) {
  d.summary(
      "Resistance of the tissue to a tip that lengthens its channel: up to the threshold the tip "
      "only compresses the "
      "tissue. Nothing while the tip moves in a channel cut before, nothing in retraction. A tip "
      "that tents a surface from inside goes on cutting along that surface.");
  d.theory(
      "One row along the needle, delta = end of the recorded channel minus tip, lambda in [0, "
      "fc]:\n"
      "0 <= delta _|_ lambda >= 0 below the threshold, lambda = fc while the channel grows.\n"
      "While a surface holds the tip from inside, the row lies along that surface: t = a - (a . n) "
      "n, made a unit vector, with a the needle's axis and n the normal; delta = t . (end of the "
      "channel minus tip).");
  d.link("path", &Cutting::path_, "The channel that is lengthened.");
  d.attribute("threshold", &Cutting::threshold_, "N", between(0, 1e6),
              "Cutting force fc, where no region says otherwise.");
  describe_regions(d, between(0, 1e6));
  d.output("force", "N",
           "Force of the tissue on the tip, along the needle; in a tent along the surface.",
           [](const Cutting& c) { return c.force_; });
}

void Cutting::initialise(Setup& setup) {
  source_id_ = setup.source_id;
  path_->add_law(*this, setup);
  find_regions(*this, setup, path_->tissue());
}

Real Cutting::threshold(const EmbeddedPoint& at) const {
  return threshold_of(path_->tissue().region(at), threshold_);
}

void Cutting::archive(Archive& a) {
  a("force", force_);
}

void Cutting::build(const StepContext&, ConstraintBuilder& builder) {
  block_ = {};
  force_ = 0;
  const Channel& channel = path_->channel();
  if (!channel.tip_inside()) return;

  const CurveBody& thread = path_->thread();
  const SolidBody& tissue = path_->tissue();
  const EmbeddedPoint& end = channel.end();
  constexpr Configuration now = Configuration::current, start = Configuration::start;
  const bool blocked = path_->tip_blocked();
  const Vec3 forward = blocked ? path_->way_along_block(builder) : Vec3(-thread.tangent(0, now));
  if (forward.isZero(0)) return;
  const Vec3 tip = thread.point(0, now);
  // Length of open channel ahead, counted along it: a retracted tip may point anywhere.
  const Vec3 tip_motion = tip - thread.point(0, start);
  const Vec3 end_motion = tissue.position(end, now) - tissue.position(end, start);
  const Real ahead = channel.end_depth() - channel.tip_depth();
  // Too far to get there in this step, even if the tip moves twice as far as it has so far.
  if (ahead > 2 * tip_motion.norm() + path_->spacing()) return;

  // The tip of a tent has gone on with the surface, beyond the end: only the way along counts.
  const BlockVector<1> gap(blocked ? forward.dot(tissue.position(end, now) - tip)
                                   : ahead + forward.dot(end_motion - tip_motion));
  block_ = builder.add<CuttingLaw>(make_key(source_id_, 0), {.threshold = threshold(end)}, gap);
  PointJacobian J;
  thread.jacobian(0, J);
  builder.couple(block_, thread, -forward.transpose(), J, tip);
  tissue.jacobian(end, J);
  builder.couple(block_, tissue, forward.transpose(), J, tip);
}

void Cutting::commit(const StepContext&, const SolvedBlocks& solved) {
  if (block_.valid()) force_ = solved.lambda(block_)[0];
}

}  // namespace sutura::suturing
