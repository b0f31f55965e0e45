#include "path_friction.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "path_friction_law.h"

namespace sutura {
namespace {

/// Surface of a stretch of needle and thread (m^2): both are cylinders, and meet at the swage.
Real surface(const CurveBody& thread, const Channel::Share& share) {
  const Real swage = thread.needle_length();
  const Real on_needle = std::max(std::min(share.high, swage) - share.low, Real(0));
  const Real on_thread = share.high - share.low - on_needle;
  return 2 * std::numbers::pi * (on_needle * thread.radius(0) + on_thread * thread.radius(thread.length()));
}

}  // namespace

void PathFriction::describe(Describe<PathFriction>& d) {
  d.summary(
      "Friction of needle and thread along their channel: every sample resists with the length it stands for, sticks below "
      "the static level, slips at the kinetic one plus a viscous part.");
  d.theory(
      "Resistance of a length l of channel on a thread of diameter d (paper, section 4.5): R = mu (l pi d p + share N) with "
      "N the force across the thread at the sample; viscous "
      "coefficient c = l pi d alpha. With delta the slip over the step of length h and w the compliance of the row, the "
      "unique solution is lambda = -delta_0 / w while |lambda| <= R_static, else\n"
      "|slip| = (|delta_0| - w R) / (1 + w c / h), lambda = -sign(delta_0) (R + c |slip| / h).");
  d.link("path", &PathFriction::path_, "The channel.");
  d.attribute("coefficient", &PathFriction::coefficient_, "1", at_least(0),
              "Kinetic friction coefficient mu.");
  d.attribute("static_coefficient", &PathFriction::static_coefficient_, "1", at_least(0),
              "Static friction coefficient; below the kinetic one it is taken equal to it.");
  d.attribute("pressure", &PathFriction::pressure_, "Pa", at_least(0),
              "Pressure p of the tissue on needle and thread.");
  d.attribute("lateral_share", &PathFriction::lateral_share_, "1", between(0, 1),
              "Share of the measured force across the thread that adds to the pressure: 0 a constant pressure, 1 the thread "
              "as on a capstan.");
  d.attribute("viscosity", &PathFriction::viscosity_, "Pa s/m", at_least(0),
              "Viscous stress alpha per slip speed.");
  d.attribute("stick_speed", &PathFriction::stick_speed_, "m/s", at_least(0),
              "Slip speed below which a sliding sample may stick at the static level again (Karnopp).");
  d.output("force", "N", "Sum of axial forces on the thread, positive towards the end of the thread.",
           [](const PathFriction& f) { return f.force_; });
  d.output("limit", "N", "Sum of the kinetic resistances of the length inserted.",
           [](const PathFriction& f) { return f.limit_; });
  d.output("sliding", "1",
           "Samples at which the thread slides towards its end less those at which the tip advances; all of them when it "
           "slides as a whole.",
           [](const PathFriction& f) { return Real(f.sliding_); });
}

void PathFriction::initialise(Setup& setup) {
  source_id_ = setup.source_id;
  if (static_coefficient_ < coefficient_) static_coefficient_ = coefficient_;
  blocks_.reserve(256);
}

Real PathFriction::resistance_per_length(Real radius) const {
  return 2 * std::numbers::pi * radius * coefficient_ * pressure_;
}

void PathFriction::build(const StepContext& context, ConstraintBuilder& builder) {
  blocks_.clear();
  limit_ = 0;
  for (const Crossing& c : path_->crossings()) {
    const Real area = surface(path_->thread(), c.share);
    PathFrictionLaw::Params params;
    const PathSample& sample = path_->channel().samples()[c.sample];
    // The force across the thread is that of the step before: exact in steady sliding.
    const Real normal = area * pressure_ + lateral_share_ * sample.lateral_force;
    params.kinetic = coefficient_ * normal;
    params.static_level = static_coefficient_ * normal;
    params.viscous = area * viscosity_ / context.dt;
    params.stick_slip = stick_speed_ * context.dt;
    limit_ += params.kinetic;
    const BlockId block =
        builder.add<PathFrictionLaw>(make_key(source_id_, c.id), params,
                                     BlockVector<1>(c.free.x()), sample.friction_mode);
    const Eigen::Matrix<Real, Eigen::Dynamic, 3> along = c.axes.topRows<1>();
    builder.couple(block, path_->thread(), along, c.thread, c.position);
    builder.couple(block, path_->tissue(), -along, c.tissue, c.position);
    blocks_.push_back({block, c.id, params.stick_slip});
  }
}

void PathFriction::commit(const StepContext&, const SolvedBlocks& solved) {
  force_ = 0;
  sliding_ = 0;
  for (const SampleBlock& b : blocks_) {
    const Real slip = std::abs(solved.delta(b.block)[0]);
    const bool slid = solved.mode(b.block) == PathFrictionLaw::slip && slip > b.stick_slip;
    force_ += solved.lambda(b.block)[0];
    if (slid) sliding_ += solved.delta(b.block)[0] > 0 ? 1 : -1;
    path_->channel().set_friction_mode(b.id, slid ? PathFrictionLaw::slip : PathFrictionLaw::stick);
  }
}

}  // namespace sutura
