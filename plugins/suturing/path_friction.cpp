#include "path_friction.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "path_friction_law.h"
#include "sutura/archive.h"

namespace sutura::suturing {
namespace {

constexpr Real rise = 0.1;  // of the friction of what slides: with more a step is taken again
constexpr int most_revisions = 8;  // and at most so often

/// Surface of a stretch of needle and of thread (m^2): both are cylinders, and meet at the swage.
struct Surface {
  Real needle, thread;
  Surface(const CurveBody& curve, const Channel::Share& share) {
    const Real swage = curve.needle_length();
    const Real on_needle = std::max(std::min(share.high, swage) - share.low, Real(0));
    const Real on_thread = share.high - share.low - on_needle;
    needle = 2 * std::numbers::pi * on_needle * curve.radius(0);
    thread = 2 * std::numbers::pi * on_thread * curve.radius(curve.length());
  }
};

}  // namespace

void PathFriction::describe(Describe<PathFriction>& d) {
  d.summary(
      "Friction of needle and thread along their channel: every sample resists with the length it "
      "stands for, sticks below "
      "the static level, slips at the kinetic one plus a viscous part.");
  d.theory(
      "Resistance of a length l of channel on a thread of diameter d (paper, section 4.5): R = mu "
      "(l pi d p + share N) with "
      "N the force across the thread, spread along it over two edges of the mesh to either side; "
      "needle and thread have a mu each. The pressure "
      "is a value, or that which opens a slit in "
      "the tissue to the girth of what is inside: a slit of length pi d / 2 under p opens by 4 (1 "
      "- nu^2) p (pi d / 4) / E at its middle "
      "(Sneddon 1946, plane strain), which is d at p = E / (pi (1 - nu^2)). Viscous "
      "coefficient c = l pi d alpha. With delta the slip over the step of length h and w the "
      "compliance of the row, the "
      "unique solution is lambda = -s / w while |lambda| <= R_static, else\n"
      "|delta| = (|s| - w R) / (1 + w c / h), lambda = -sign(s) (R + c |delta| / h), with s the "
      "slip "
      "without that force.");
  d.link("path", &PathFriction::path_, "The channel.");
  d.attribute("coefficient", &PathFriction::coefficient_, "1", between(0, 100),
              "Kinetic friction coefficient mu of the needle, and of the thread unless "
              "`thread_material` says otherwise.");
  d.attribute("static_coefficient", &PathFriction::static_coefficient_, "1", between(0, 100),
              "Static friction coefficient; below the kinetic one it is taken equal to it.");
  d.attribute(
      "thread_material", &PathFriction::thread_material_, {"as_needle", "monofilament", "braided"},
      "Surface of the thread: that of the needle, monofilament (mu 0.15) or braided (mu 0.3). "
      "Measured values scatter from 0.1 to "
      "0.4, braids above monofilaments; the ratio of static to kinetic is that of the needle.");
  d.attribute("pressure", &PathFriction::pressure_, "Pa", between(0, 1e12),
              "Pressure p of the tissue on needle and thread, where it is given as a value.");
  d.attribute(
      "pressure_from", &PathFriction::pressure_from_, {"value", "tissue"},
      "Where the pressure comes from: the value above, or the stiffness of the tissue, layer by "
      "layer; the border of two is told to an eighth of the spacing of samples.");
  d.attribute("lateral_share", &PathFriction::lateral_share_, "1", between(0, 1),
              "Share of the measured force across the thread that adds to the pressure: 0 a "
              "constant pressure, 1 the thread "
              "as on a capstan.");
  d.attribute("viscosity", &PathFriction::viscosity_, "Pa s/m", between(0, 1e12),
              "Viscous stress alpha per slip speed.");
  d.attribute(
      "stick_speed", &PathFriction::stick_speed_, "m/s", between(0, 1000),
      "Slip speed below which a sliding sample may stick at the static level again (Karnopp).");
  d.output("force", "N",
           "Sum of axial forces on the thread, positive towards the end of the thread.",
           [](const PathFriction& f) { return f.force_; });
  d.output("limit", "N", "Sum of the kinetic resistances of the length inserted.",
           [](const PathFriction& f) { return f.limit_; });
  d.output("sliding", "1",
           "Samples at which the thread slides towards its end less those at which the tip "
           "advances; all of them when it "
           "slides as a whole.",
           [](const PathFriction& f) { return Real(f.sliding_); });
}

void PathFriction::initialise(Setup& setup) {
  source_id_ = setup.source_id;
  path_->add_law(*this, setup);
  static_over_kinetic_ =
      coefficient_ > 0 ? std::max(static_coefficient_ / coefficient_, Real(1)) : Real(1);
  blocks_.reserve(256);
  pressures_.reserve(256);
  left_.reserve(256);
  if (pressure_from_ == PressureFrom::tissue &&
      !(path_->tissue().elasticity({.element = 0}).young > 0))
    setup.error(
        *this,
        "pressure_from=\"tissue\", but this tissue does not say how stiff it is; give a pressure");
}

void PathFriction::archive(Archive& a) {
  a("force", force_);
  a("limit", limit_);
  a("sliding", sliding_);
  a.list("left", left_, [](Archive& each, Left& l) {
    each("sample", l.sample);
    each("slip", l.slip);
  });
}

Real PathFriction::left_at(std::uint64_t sample) const {
  const auto it = std::lower_bound(left_.begin(), left_.end(), sample,
                                   [](const Left& l, std::uint64_t id) { return l.sample < id; });
  return it != left_.end() && it->sample == sample ? it->slip : 0;
}

Real PathFriction::thread_coefficient() const {
  switch (thread_material_) {
    case ThreadMaterial::monofilament:
      return 0.15;
    case ThreadMaterial::braided:
      return 0.3;
    case ThreadMaterial::as_needle:
      break;
  }
  return coefficient_;
}

Real PathFriction::pressure(const EmbeddedPoint& at) const {
  if (pressure_from_ == PressureFrom::value) return pressure_;
  const Elasticity tissue = path_->tissue().elasticity(at);
  return tissue.young / (std::numbers::pi * (1 - tissue.poisson * tissue.poisson));
}

/// Mean over a straight stretch of channel at rest, which is `part` of the way from one point to
/// another.
Real PathFriction::pressure_along(const EmbeddedPoint& from, const EmbeddedPoint& to,
                                  Real part) const {
  constexpr int points = 4;
  const SolidBody& tissue = path_->tissue();
  const Vec3 begin = tissue.position(from, Configuration::rest);
  const Vec3 way = part * (tissue.position(to, Configuration::rest) - begin);
  Real sum = 0;
  for (int k = 0; k < points; ++k) {
    const Vec3 at = begin + (k + 0.5) / points * way;
    sum += pressure(tissue.locate(at, Configuration::rest).value_or(from));
  }
  return sum / points;
}

/// As much of the way from a sample to the tip, towards `ahead`, as the tip has come.
Real PathFriction::pressure_to_tip(const PathSample& sample, const EmbeddedPoint& ahead,
                                   Real length) const {
  const Vec3 way = path_->tissue().position(ahead, Configuration::start) -
                   path_->tissue().position(sample.at, Configuration::start);
  if (!(way.norm() > 0)) return pressure(sample.at);
  return pressure_along(sample.at, ahead, std::min(length / way.norm(), Real(1)));
}

/// Mean over what a sample stands for: half of the way to its neighbours, or all of that to the
/// tip.
Real PathFriction::mean_pressure(const Crossing& c) const {
  const Channel& channel = path_->channel();
  const std::vector<PathSample>& samples = channel.samples();
  const PathSample& sample = samples[c.sample];
  const Real up = c.share.high - sample.abscissa, down = sample.abscissa - c.share.low;
  Real above = pressure(sample.at), below = above;
  if (pressure_from_ == PressureFrom::value || !(up + down > 0)) return above;
  const std::size_t next = c.sample + 1;
  if (channel.is_joined(c.sample)) above = pressure_along(sample.at, samples[c.sample - 1].at, 0.5);
  if (next == channel.passed() && channel.tip_inside())
    below = pressure_to_tip(sample, next < samples.size() ? samples[next].at : channel.end(), down);
  else if (next < channel.passed() && channel.is_joined(next))
    below = pressure_along(sample.at, samples[next].at, 0.5);
  return (up * above + down * below) / (up + down);
}

Real PathFriction::needle_resistance(const EmbeddedPoint& at) const {
  return 2 * std::numbers::pi * path_->thread().radius(0) * coefficient_ * pressure(at);
}

void PathFriction::build(const StepContext& context, ConstraintBuilder& builder) {
  blocks_.clear();
  limit_ = 0;
  const std::span<const Crossing> crossings = path_->crossings();
  if (context.pass == 0) {  // the samples and what they are fixed to stay for the whole step
    pressures_.clear();
    for (const Crossing& c : crossings) pressures_.push_back(mean_pressure(c));
  }
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const Crossing& c = crossings[i];
    const Surface area(path_->thread(), c.share);
    PathFrictionLaw::Params params;
    const PathSample& sample = path_->channel().samples()[c.sample];
    const Real p = pressures_[i];
    // The force across the thread is that of the step before: exact in steady sliding.
    const Real lateral = lateral_share_ * sample.lateral_force;
    const bool on_needle = area.needle > area.thread;
    params.kinetic = coefficient_ * (area.needle * p + (on_needle ? lateral : 0)) +
                     thread_coefficient() * (area.thread * p + (on_needle ? 0 : lateral));
    params.static_level = static_over_kinetic_ * params.kinetic;
    params.viscous = (area.needle + area.thread) * viscosity_ / context.dt;
    // A millionth of what the sample stands for is no slip but rounding, and must not decide
    // between two levels.
    params.stick_slip = std::max(stick_speed_ * context.dt, 1e-6 * (c.share.high - c.share.low));
    limit_ += params.kinetic;
    const BlockId block = builder.add<PathFrictionLaw>(make_key(source_id_, c.id), params,
                                                       BlockVector<1>(c.gap.x() + left_at(c.id)));
    const Directions along = c.axes.topRows<1>();
    builder.couple(block, path_->thread(), along, c.thread, c.position);
    builder.couple(block, path_->tissue(), -along, c.tissue, c.position);
    blocks_.push_back({block, c.id, params});
  }
}

/// Samples that slide by the friction of the step before may not do so by that of this one, where
/// tension rises along the whole channel: with all of what presses now the step is taken again.
bool PathFriction::revise(const StepContext&, const SolvedBlocks& solved) {
  lacks_ = 0;
  if (lateral_share_ == 0) return false;
  path_->find_pressing(solved);
  Real more = 0, all = 0;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const SampleBlock& b = blocks_[i];
    const Crossing& c = path_->crossings()[i];
    if (!slides(solved, b)) continue;
    const Surface area(path_->thread(), c.share);
    const Real mu = area.needle > area.thread ? coefficient_ : thread_coefficient();
    const Real before = path_->channel().samples()[c.sample].lateral_force;
    more += mu * lateral_share_ * (path_->pressing(i) - before);
    all += b.params.kinetic;
  }
  if (!(more > rise * (all + more))) return false;
  if (revisions_ == most_revisions) {
    lacks_ = more / (all + more);
    return false;
  }
  path_->keep_pressing();
  ++revisions_;
  return true;
}

std::string PathFriction::fault() const {
  if (lacks_ == 0) return {};
  char text[100];
  std::snprintf(text, sizeof text,
                "the friction of what presses across the thread lags by %.0f %%: a shorter step",
                100 * lacks_);
  return text;
}

bool PathFriction::slides(const SolvedBlocks& solved, const SampleBlock& b) const {
  const Real slip = solved.delta(b.block)[0], force = solved.lambda(b.block)[0];
  return PathFrictionLaw::at_limit(b.params, solved.mode(b.block), force) &&
         std::abs(slip) > b.params.stick_slip;
}

void PathFriction::commit(const StepContext&, const SolvedBlocks& solved) {
  revisions_ = 0;
  force_ = 0;
  sliding_ = 0;
  left_.clear();
  for (const SampleBlock& b : blocks_) {
    const Real slip = solved.delta(b.block)[0], force = solved.lambda(b.block)[0];
    const bool may_slide = PathFrictionLaw::at_limit(b.params, solved.mode(b.block), force);
    force_ += force;
    if (slides(solved, b)) sliding_ += slip > 0 ? 1 : -1;
    left_.push_back({b.sample, may_slide ? 0 : slip});
  }
}

}  // namespace sutura::suturing
