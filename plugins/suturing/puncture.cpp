#include "puncture.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "puncture_law.h"
#include "sutura/archive.h"

namespace sutura::suturing {
namespace {

// In units of `reach`.
constexpr Real arrived = 0.01;  // a tip that is closer to a front from inside stands at it

// In units of the radius of the needle: where the tip goes no further in a part of a step, the
// place of a puncture in it is known well enough.
constexpr Real placed = 0.5;

constexpr Real rounding = 1e-6;  // of a force

}  // namespace

void Puncture::describe(Describe<Puncture>& d) {
  d.summary(
      "Contact of the needle tip with the surface of a tissue, from outside (entry) and from "
      "inside (exit): frictional "
      "contact up to a force threshold; at the threshold the tip goes through and a channel begins "
      "or ends.");
  d.theory(
      "Paper, section 4.2: 0 <= delta _|_ lambda >= 0 while lambda < fp; 0 <= -delta _|_ fp - "
      "lambda >= 0 while lambda > 0, "
      "delta = n^T (tip - surface point). Punctures that are due fire together, once the end of "
      "the step has been measured; another pass follows with the law of the pierced state: "
      "bilateral across the needle, cutting along it. The step in which that happens is divided, "
      "until the tip goes no further in a part than half of the radius of the needle.");
  d.link("path", &Puncture::path_, "The channel that begins and ends at the punctures.");
  d.link("cutting", &Puncture::cutting_, "Resistance once through; none without.").optional();
  d.link("drag", &Puncture::drag_, "Friction on what slips in during the step of the puncture.")
      .optional();
  d.attribute("threshold", &Puncture::threshold_, "N", between(1e-12, 1e9),
              "Puncture force fp on entry, where no region says otherwise.");
  d.attribute("exit_threshold", &Puncture::exit_threshold_, "N", between(0, 1e9),
              "Puncture force from inside; 0: the one on entry there.");
  describe_regions(d, between(1e-12, 1e9), ", on the surface and as a layer under another");
  d.attribute("friction", &Puncture::friction_, "1", between(0, 100),
              "Coulomb coefficient of the tip on the surface before it goes through.");
  d.attribute(
      "tip_radius", &Puncture::tip_radius_, "m", between(0, 0.1),
      "Radius of the tip: a small force F dents thick tissue by (1 - nu^2) F / (2 radius "
      "E), whatever the mesh; at the threshold by up to three radii of the disc that bears "
      "it, so a finer tip makes no difference, nor does one blunter than that disc. 0: as "
      "wide as the tissue needs to bear the threshold at a mean pressure of 0.3 E, up to ten "
      "times the radius of the needle. A tip that presses harder than 0.45 E on that is a "
      "fault of the step.");
  d.attribute("reach", &Puncture::reach_, "m", between(1e-6, 1e3),
              "Distance at which the tip looks for the next surface or layer, beyond its motion in "
              "a step; a layer thinner than a twentieth of both may not be seen. Deeper than this "
              "inside without a puncture, the tip counts as an overrun.");
  d.output("force", "N",
           "Force of the surface on the tip: along the normal while it presses, along the needle "
           "in the step in which it goes through.",
           [](const Puncture& p) { return p.force_; });
  d.output("peak_force", "N", "Largest force along the normal so far.",
           [](const Puncture& p) { return p.peak_force_; });
  d.output("punctures", "1", "Times the tip has gone through a surface.",
           [](const Puncture& p) { return Real(p.count_); });
  d.output("overruns", "1",
           "Times the tip was found inside without a puncture (the mesh is too coarse for the "
           "indentation), outside again or past a whole wall (the step is too long for what is "
           "as thin, or walls overlap).",
           [](const Puncture& p) { return Real(p.overruns_); });
  d.output("state", "",
           "Contact of the tip: free, pressing (a surface from outside), layer (the next layer) or "
           "tenting (a surface from inside).",
           [](const Puncture& p) -> std::string {
             if (p.front_ == Front::none || p.force_ <= 0) return "free";
             if (p.front_ == Front::entry) return "pressing";
             return p.front_ == Front::layer ? "layer" : "tenting";
           });
}

void Puncture::initialise(Setup& setup) {
  source_id_ = setup.source_id;
  path_->add_law(*this, setup);
  find_regions(*this, setup, path_->tissue());
}

void Puncture::ready(Setup& setup) {
  const Vec3 tip = path_->thread().point(0, Configuration::current);
  const auto foot = path_->tissue().closest_surface(tip, reach_, Configuration::current);
  const bool touching = foot && foot->distance > -still_outside * reach_;
  if (!touching && path_->tissue().locate(tip, Configuration::current)) {
    setup.error(*this, "the needle tip starts inside the tissue; move the needle or the tissue");
  }
}

void Puncture::archive(Archive& a) {
  a("front", front_);
  a("region", region_);
  a("threshold_here", threshold_here_);
  a("presses", presses_);
  a("place", place_);
  a("left", left_);
  a("lifted", lifted_);
  a("touched", touched_.at);
  a("touched_triangle", touched_.triangle);
  footprint_.archive(a);
  a("count", count_);
  a("overruns", overruns_);
  a("force", force_);
  a("peak_force", peak_force_);
}

/// What the tip faces is found where the step begins and kept; passes only follow it. A guess that
/// goes further than the first one may meet what that did not.
void Puncture::detect(const StepContext& context) {
  if (context.pass == 0) {
    const bool inside = path_->channel().tip_inside();
    find_front();
    const Vec3 tip = path_->thread().point(0, Configuration::start);
    const Real to_go = touched_.normal.dot(tip - touched_.position);
    blocked_ = inside && front_ != Front::none && to_go < arrived * reach_;
  }
  const bool meets = front_ == Front::none && context.pass > 0 && meet_on_the_way();
  if (meets) lay_footprint();
  find_walls_behind(meets || context.pass == 0);
  if (front_ != Front::none && front_ != Front::overrun) {
    follow(front_, footprint_, touched_);
    touched_.position -= left_ * touched_.normal;
  }
  for (std::size_t k = 0; k < walls_behind_; ++k)
    follow(behind_[k].front, behind_[k].footprint, behind_[k].touched);
  path_->set_tip_blocked({});
  if (blocked_) path_->set_tip_blocked(SuturePath::Block{touched_.normal, key_of(front_, count_)});
}

void Puncture::lay_footprint() {
  if (front_ == Front::layer)
    footprint_.find(touched_);
  else
    lay(footprint_, front_, touched_);
}

/// A tip that comes to an exit may have brought a tent with it. A wound may stand open, and what
/// lies beside an entry at rest may be far away.
void Puncture::lay(Footprint& footprint, Front front, const SurfacePoint& touched) const {
  const auto shape = front == Front::exit ? Configuration::rest : Configuration::start;
  footprint.find(path_->tissue(), touched, pressing(front, touched), shape);
}

Footprint::Pressing Puncture::pressing(Front front, const SurfacePoint& touched) const {
  return {.tip_radius = tip_radius_,
          .shaft_radius = path_->thread().radius(0),
          .force = threshold_at(front, touched)};
}

Real Puncture::threshold_at(Front front, const SurfacePoint& touched) const {
  if (front == Front::exit && exit_threshold_ > 0) return exit_threshold_;
  return threshold_of(path_->tissue().region(touched.at), threshold_);
}

/// The surface point and its normal at the present guess.
void Puncture::follow(Front front, const Footprint& footprint, SurfacePoint& touched) const {
  const SolidBody& tissue = path_->tissue();
  touched.position = footprint.position(tissue, Configuration::current);
  if (front == Front::layer)
    touched.normal = path_->thread().tangent(0, Configuration::current);
  else
    touched.normal =
        footprint.normal(tissue, Configuration::current) * (front == Front::exit ? -1 : 1);
}

void Puncture::build(const StepContext&, ConstraintBuilder& builder) {
  block_ = {};
  for (Wall& wall : behind_) wall.block = {};
  force_ = 0;
  if (front_ == Front::none || front_ == Front::overrun) return;
  threshold_here_ = threshold_at(front_, touched_);
  block_ = add_block(builder, front_, footprint_, touched_, count_);
  // Only what has gone in can come out again: before, the two sides may contradict each other, as
  // at the edge of a block, and both forces would grow up to their thresholds. The key is that of
  // the next step, in which the tip faces it.
  const auto is_through = [&](Front front, Index count) {
    const Mode mode = builder.known_mode(key_of(front, count), PunctureLaw::pressing);
    return mode == PunctureLaw::penetrated;
  };
  bool before = is_through(front_, count_);
  path_->set_tip_let_out(before && front_ == Front::exit);
  Index count = count_;
  for (std::size_t k = 0; k < walls_behind_ && before; ++k) {
    Wall& wall = behind_[k];
    wall.block = add_block(builder, wall.front, wall.footprint, wall.touched, ++count);
    before = is_through(wall.front, count);
  }
}

/// Every front has a key of its own, so that it does not begin in the mode of the one before.
Key Puncture::key_of(Front front, Index count) const {
  const auto number = static_cast<std::uint64_t>(8 * count) + static_cast<std::uint64_t>(front);
  return make_key(source_id_, number);
}

BlockId Puncture::add_block(ConstraintBuilder& builder, Front front, const Footprint& footprint,
                            const SurfacePoint& touched, Index count) const {
  const CurveBody& thread = path_->thread();
  const SolidBody& tissue = path_->tissue();
  const Vec3 tip = thread.point(0, Configuration::current);

  PunctureLaw::Params params;
  params.normal = touched.normal;
  params.axis = -thread.tangent(0, Configuration::current);
  params.puncture_force = threshold_at(front, touched);
  params.cutting_force = front != Front::exit && cutting_ ? cutting_->threshold(touched.at) : 0;
  // What goes in during the step of the puncture itself has no sample yet that could drag on it.
  params.drag = front != Front::exit && drag_ ? drag_->needle_resistance(touched.at) : 0;
  params.hold = front != Front::exit;
  params.friction = front == Front::layer ? 0 : friction_;
  // From inside there is no room for a tip beyond the surface: the near field of an exit is left
  // out.
  params.compliance = front == Front::entry ? footprint.compliance() : 0;

  const Vec3 gap = tip - touched.position;
  const BlockId block =
      builder.add<PunctureLaw>(key_of(front, count), params, BlockVector<3>(gap),
                               PunctureLaw::pressing, {.force = params.puncture_force});
  const Directions world = Mat3::Identity();
  const Vec3 way = tip - thread.point(0, Configuration::start);
  if (way.norm() > placed * thread.radius(0)) builder.time_event(block);
  PointJacobian J;
  thread.jacobian(0, J);
  builder.couple(block, thread, world, J, tip);
  footprint.couple(builder, block, tissue, -Mat3::Identity(), tip);
  return block;
}

void Puncture::commit(const StepContext&, const SolvedBlocks& solved) {
  if (front_ == Front::overrun) {
    ++overruns_;
    begin_bite(touched_, false);
  }
  overloads_ = false;
  passed_by_ = false;
  let_out_ = false;
  if (!block_.valid()) presses_ = false;
  if (block_.valid()) commit_front(solved);
  got_out_ = path_->channel().got_out() && !let_out_;
  if (got_out_ || passed_by_) ++overruns_;
}

std::string Puncture::fault() const {
  if (front_ == Front::overrun) return "the tip got in without a puncture (an overrun)";
  if (got_out_) return "the tip got out without a puncture (an overrun): the step is too long";
  if (passed_by_)
    return "the tip got through a wall without a puncture (an overrun): the step is too long, or "
           "walls overlap for want of a Contact";
  if (!overloads_) return {};
  char text[160];
  std::snprintf(text, sizeof text,
                "the tip presses with more than %.2g N: the tissue is too soft for that, its dent "
                "and the place of a puncture are not to be relied on",
                footprint_.bears());
  return text;
}

void Puncture::commit_front(const SolvedBlocks& solved) {
  const bool goes_through = solved.mode(block_) == PunctureLaw::penetrated;
  // A puncture fires at the threshold.
  force_ = goes_through ? threshold_here_ : touched_.normal.dot(solved.force(block_));
  overloads_ = force_ > (1 + rounding) * footprint_.bears();
  if (!goes_through) {
    peak_force_ = std::max(peak_force_, force_);
    lifted_ = !(force_ > 0);
    presses_ = !lifted_ || (presses_ && front_ != Front::layer);
    place_ = front_;
    return;
  }
  presses_ = false;
  force_ = path_->thread().tangent(0, Configuration::current).dot(solved.force(block_));
  // At the end of this step the force is that of the pierced state. The largest one was the
  // threshold, at which the puncture fired.
  peak_force_ = std::max(peak_force_, threshold_here_);
  go_through(front_, touched_, goes_through_wall(solved, 0));
  commit_walls_behind(solved);
  // What holds the tip is the mean of a surface: it may be past some facets of that, and of a wall
  // that lies against it.
  passed_by_ = !presses_ && path_->channel().has_passed_wall();
}

/// `goes_on`: through what is behind that as well.
void Puncture::go_through(Front front, const SurfacePoint& touched, bool goes_on) {
  ++count_;
  let_out_ = front == Front::exit;
  Channel& channel = path_->channel();
  switch (front) {
    case Front::entry:
      begin_bite(touched, goes_on);
      break;
    case Front::layer:
      channel.record();
      region_ = path_->tissue().region(touched.at);
      break;
    case Front::exit:
      if (channel.tip_inside()) channel.leave(touched.at);
      break;
    case Front::none:
    case Front::overrun:
      break;
  }
}

bool Puncture::goes_through_wall(const SolvedBlocks& solved, std::size_t wall) const {
  if (wall >= walls_behind_ || !behind_[wall].block.valid()) return false;
  return solved.mode(behind_[wall].block) == PunctureLaw::penetrated;
}

/// The tip has gone through its front, and on to what is behind: it presses there, or is through
/// that too.
void Puncture::commit_walls_behind(const SolvedBlocks& solved) {
  for (std::size_t k = 0; k < walls_behind_ && behind_[k].block.valid(); ++k) {
    Wall& wall = behind_[k];
    const bool goes_through = goes_through_wall(solved, k);
    const Real threshold = threshold_at(wall.front, wall.touched);
    const Real force = goes_through ? threshold : wall.touched.normal.dot(solved.force(wall.block));
    if (!(force > 0)) return;
    peak_force_ = std::max(peak_force_, force);
    overloads_ = overloads_ || force > (1 + rounding) * wall.footprint.bears();
    if (goes_through) {
      go_through(wall.front, wall.touched, goes_through_wall(solved, k + 1));
      continue;
    }
    presses_ = true;
    lifted_ = false;
    place_ = wall.front;
    left_ = 0;
    threshold_here_ = threshold;
    touched_ = wall.touched;
    std::swap(footprint_, wall.footprint);
    return;
  }
}

void Puncture::begin_bite(const SurfacePoint& touched, bool goes_on) {
  // Beside an old mouth the tip may have slid into that channel in the same step: then the bite has
  // begun already.
  if (!path_->channel().tip_inside()) path_->channel().enter(touched.at, goes_on);
  region_ = path_->tissue().region(touched.at);
}

}  // namespace sutura::suturing
