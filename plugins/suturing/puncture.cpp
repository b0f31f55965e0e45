#include "puncture.h"

#include <algorithm>

#include "puncture_law.h"
#include "sutura/archive.h"

namespace sutura::suturing {
namespace {

// In units of `reach`.
constexpr Real still_outside = 1e-3;  // a tip that begins no deeper than this lies on the surface
constexpr Real arrived = 0.01;        // a tip that is closer to a front from inside stands at it
constexpr Real behind = 0.1;          // from where, behind the tip, the front of a layer is sought
constexpr Real found = 1e-6;          // and to which accuracy
// A surface that is no further from where the tip pressed than so many times the way that the tip
// slid is where it slid to; one that is further is another.
constexpr Real as_far = 2;

constexpr Real along = 1e-3;  // sine of the angle at which a needle runs along a wall, not at it

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
      "delta = n^T (tip - surface point). The puncture fires only on converged multipliers, all "
      "due ones at once, and the "
      "solve goes on with the law of the pierced state: bilateral across the needle, cutting along "
      "it.");
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
  d.attribute("tip_radius", &Puncture::tip_radius_, "m", between(0, 0.1),
              "Radius of the tip: a small force F dents thick tissue by (1 - nu^2) F / (2 radius "
              "E), whatever the mesh. 0: as wide as the tissue needs to bear the threshold at a "
              "mean pressure of 0.3 E.");
  d.attribute("reach", &Puncture::reach_, "m", between(1e-6, 1e3),
              "Distance at which the tip looks for the next surface or layer, beyond its motion in "
              "a step; deeper than this "
              "inside without a puncture, it counts as an overrun.");
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
           "indentation), or outside again (the step is too long for what is as thin).",
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
  path_->set_tip_blocked(blocked_);
  if (front_ == Front::none && context.pass > 0 && meet_on_the_way()) lay_footprint();
  if (front_ != Front::none && front_ != Front::overrun) follow_front();
}

void Puncture::lay_footprint() {
  if (front_ == Front::layer)
    footprint_.find(touched_);
  else
    footprint_.find(path_->tissue(), touched_, tip_radius_, path_->thread().radius(0),
                    threshold_of_front());
}

/// Whether the guess has led the tip through a surface that it did not face. It faces it now.
bool Puncture::meet_on_the_way() {
  const bool inside = path_->channel().tip_inside();
  if (inside && !path_->channel().tip_at_end()) return false;
  const Vec3 tip = path_->thread().point(0, Configuration::start);
  const Vec3 to = path_->thread().point(0, Configuration::current);
  const Vec3 back = path_->thread().tangent(0, Configuration::start);
  const auto hit =
      path_->tissue().crossing(tip, to, Configuration::start, inside ? Vec3(-back) : back);
  if (!hit || std::abs(hit->normal.dot(back)) < along) return false;
  if (!inside && path_->channel().mouth_near(hit->position)) return false;
  touched_ = *hit;
  if (inside) touched_.normal *= -1;
  front_ = inside ? Front::exit : Front::entry;
  return true;
}

/// What the tip faces at the start of the step.
void Puncture::find_front() {
  if (presses_ && keeps_place()) return;
  search_front();
  if (front_ == Front::none || front_ == Front::overrun) return;
  lay_footprint();
  if (front_ == Front::layer) return;
  const Vec3 back = path_->thread().tangent(0, Configuration::start);
  const Vec3 out = footprint_.normal(path_->tissue(), Configuration::start);
  if (out.dot(front_ == Front::exit ? Vec3(-back) : back) < along) front_ = Front::none;
}

void Puncture::search_front() {
  front_ = Front::none;
  if (!path_->channel().tip_inside()) {
    front_ = find_entry();
  } else if (path_->channel().tip_at_end()) {
    front_ = find_exit();
    if (front_ == Front::none) front_ = find_layer();
  }
}

/// A tip that presses keeps its place in the tissue, and where it slides, the place slides along
/// with it. Sought anew, the tip of a tent would be found now before, now behind one of its few
/// facets, and the tent be let go. False where the tip stands clear of it.
bool Puncture::keeps_place() {
  const SolidBody& tissue = path_->tissue();
  constexpr Configuration start = Configuration::start;
  const Vec3 tip = path_->thread().point(0, start);
  const Vec3 n = footprint_.normal(tissue, start);
  const Vec3 way = tip - footprint_.position(tissue, start);
  const Real side = place_ == Front::exit ? -1 : 1;
  if (lifted_ && is_clear(side * way.dot(n))) return false;
  front_ = place_;
  const Vec3 slip = way - way.dot(n) * n;
  const Vec3 from = tissue.position(touched_.at, start);
  if (front_ == Front::entry && is_past_edge(tip, n, (tip - from).norm())) {
    front_ = Front::none;
    return true;
  }
  if (slip.norm() > still_outside * reach_) {
    const auto to = tissue.closest_surface(from + slip, as_far * slip.norm(), start, n);
    if (to) touched_ = *to;
    lay_footprint();
    touched_.position = tip - way.dot(n) * n;
    touched_.normal *= side;
    footprint_.put_under(touched_.position, tissue);
  }
  return true;
}

/// Whether a tip without force is free of its place: it stands before the surface that a search
/// finds, and that is not much further than the place. `above`: the place.
bool Puncture::is_clear(Real above) {
  if (!(above > 0)) return false;
  const Front before = front_;
  const SurfacePoint pressed = touched_;
  search_front();
  const Real distance = front_ == Front::exit ? -touched_.distance : touched_.distance;
  bool clear = front_ == place_ && distance > 0 && distance < as_far * above;
  if (front_ == Front::none || front_ == Front::layer) {
    const Vec3 tip = path_->thread().point(0, Configuration::start);
    const bool in = path_->tissue().locate(tip, Configuration::start).has_value();
    clear = in == path_->channel().tip_inside();
  }
  front_ = before;
  touched_ = pressed;
  return clear;
}

/// The law knows a plane, which goes on beside the surface. `apart`: tip and surface under it.
bool Puncture::is_past_edge(const Vec3& tip, const Vec3& normal, Real apart) const {
  const SolidBody& tissue = path_->tissue();
  constexpr Configuration start = Configuration::start;
  const Vec3 far = (reach_ + apart) * normal;
  if (tissue.crossing(tip + far, tip - far, start, normal)) return false;
  const auto foot = tissue.closest_surface(tip, reach_ + apart, start, normal);
  if (!foot) return true;
  const Vec3 r = tip - foot->position;
  return (r - normal.dot(r) * normal).norm() > path_->thread().radius(0);
}

Real Puncture::threshold_of_front() const {
  if (front_ == Front::exit && exit_threshold_ > 0) return exit_threshold_;
  return threshold_of(path_->tissue().region(touched_.at), threshold_);
}

/// The surface point and its normal at the present guess.
void Puncture::follow_front() {
  const SolidBody& tissue = path_->tissue();
  touched_.position = footprint_.position(tissue, Configuration::current);
  if (front_ == Front::layer)
    touched_.normal = path_->thread().tangent(0, Configuration::current);
  else
    touched_.normal =
        footprint_.normal(tissue, Configuration::current) * (front_ == Front::exit ? -1 : 1);
}

Puncture::Front Puncture::find_entry() {
  const CurveBody& thread = path_->thread();
  const Vec3 tip = thread.point(0, Configuration::start);
  const Real motion = (thread.point(0, Configuration::current) - tip).norm();
  // A tip that presses stands below the surface of the mesh by the dent of its near field.
  const Real dent = footprint_.compliance() * threshold_here_;
  // Only what the needle points at: not the surface it has just left, on the other side of which
  // the next may lie at once (a slit, two lips of a wound).
  const Vec3 back = thread.tangent(0, Configuration::start);
  const auto hit =
      path_->tissue().closest_surface(tip, motion + reach_ + dent, Configuration::start, back);
  if (path_->channel().mouth_near(tip)) return Front::none;
  const bool deep = !hit || hit->distance < -reach_ - dent;
  if (deep && path_->tissue().locate(tip, Configuration::start)) {
    // An indentation deeper than the elements can follow turns them inside out, and the tip is in
    // without a puncture.
    const auto way_in =
        path_->tissue().closest_surface(tip, thread.length(), Configuration::start, back);
    touched_ = way_in
                   ? *way_in
                   : *path_->tissue().closest_surface(tip, thread.length(), Configuration::start);
    return Front::overrun;
  }
  if (!hit || is_beyond(*hit)) return Front::none;
  if (is_beside(reach_ + dent)) return Front::none;
  touched_ = *hit;
  return Front::entry;
}

/// Behind a surface that it has not pressed in, and not inside: on the far side of something thin.
bool Puncture::is_beyond(const SurfacePoint& hit) const {
  if (hit.distance > -still_outside * reach_) return false;
  const Vec3 tip = path_->thread().point(0, Configuration::start);
  return !path_->tissue().locate(tip, Configuration::start);
}

/// The law knows a plane, which goes on beside the surface. Whether the tip goes past the edge of
/// the surface, as it stands and as its first guess says: neither stands over it, nor is the
/// surface on its way or where the needle points, up to `reach`.
bool Puncture::is_beside(Real reach) const {
  const CurveBody& thread = path_->thread();
  const SolidBody& tissue = path_->tissue();
  const Vec3 tip = thread.point(0, Configuration::start);
  const Vec3 to = thread.point(0, Configuration::current);
  const Vec3 back = thread.tangent(0, Configuration::start);
  const auto is_over = [&](const SurfacePoint& s) {
    const Vec3 r = to - s.position;
    const Vec3 n = tissue.surface_normal(s.triangle, Configuration::start);
    return n.dot(back) > along && (r - n.dot(r) * n).norm() < thread.radius(0);
  };
  const auto meets = [&](const Vec3& from, const Vec3& end) {
    return tissue.crossing(from, end, Configuration::start, back).has_value();
  };
  if (meets(tip, to) || meets(to + reach * back, to - reach * back)) return false;
  const auto foot = tissue.closest_surface(to, reach, Configuration::start, back);
  return !foot || !is_over(*foot);
}

Puncture::Front Puncture::find_exit() {
  const CurveBody& thread = path_->thread();
  const SolidBody& tissue = path_->tissue();
  const Vec3 tip = thread.point(0, Configuration::start);
  const Vec3 forward = -thread.tangent(0, Configuration::start);
  const Real reach = reach_ + (thread.point(0, Configuration::current) - tip).norm();
  auto hit = tissue.crossing(tip, tip + reach * forward, Configuration::start, forward);
  // In the step in which it got in, the tip may have gone on through a thin sheet.
  if (!hit && !tissue.locate(tip, Configuration::start))
    hit = tissue.closest_surface(tip, reach_, Configuration::start, forward);
  if (!hit) return Front::none;
  touched_ = *hit;
  touched_.normal = -hit->normal;
  return Front::exit;
}

/// The tip stands before a layer with a threshold of its own. The mesh has no surface there: the
/// front is where the region changes along the needle, and its normal is the needle's axis.
Puncture::Front Puncture::find_layer() {
  const CurveBody& thread = path_->thread();
  const SolidBody& tissue = path_->tissue();
  const Vec3 tip = thread.point(0, Configuration::start);
  const Vec3 forward = -thread.tangent(0, Configuration::start);
  const Real reach = reach_ + (thread.point(0, Configuration::current) - tip).norm();
  const auto beyond = tissue.locate(tip + reach * forward, Configuration::start);
  if (!beyond) return Front::none;
  const int next = tissue.region(*beyond);
  if (next == region_) return Front::none;
  if (!has_threshold(next)) {
    const auto here = tissue.locate(tip, Configuration::start);
    if (here) region_ = tissue.region(*here);
    return Front::none;
  }
  Real low = -behind * reach_;
  Real high = reach;
  EmbeddedPoint at = *beyond;
  while (high - low > found * reach_) {
    const Real middle = 0.5 * (low + high);
    const auto p = tissue.locate(tip + middle * forward, Configuration::start);
    if (p && tissue.region(*p) == next) {
      high = middle;
      at = *p;
    } else {
      low = middle;
    }
  }
  touched_ = {.at = at,
              .triangle = -1,
              .position = tissue.position(at, Configuration::start),
              .normal = -forward,
              .distance = high};
  return Front::layer;
}

void Puncture::build(const StepContext&, ConstraintBuilder& builder) {
  block_ = {};
  force_ = 0;
  if (front_ == Front::none || front_ == Front::overrun) return;
  const CurveBody& thread = path_->thread();
  const SolidBody& tissue = path_->tissue();
  const Vec3 tip = thread.point(0, Configuration::current);

  PunctureLaw::Params params;
  params.normal = touched_.normal;
  params.axis = -thread.tangent(0, Configuration::current);
  params.puncture_force = threshold_of_front();
  threshold_here_ = params.puncture_force;
  params.cutting_force = front_ != Front::exit && cutting_ ? cutting_->threshold(touched_.at) : 0;
  // What goes in during the step of the puncture itself has no sample yet that could drag on it.
  params.drag = front_ != Front::exit && drag_ ? drag_->needle_resistance(touched_.at) : 0;
  params.hold = front_ != Front::exit;
  params.friction = front_ == Front::layer ? 0 : friction_;
  // From inside there is no room for a tip beyond the surface: the near field of an exit is left
  // out.
  params.compliance = front_ == Front::entry ? footprint_.compliance() : 0;

  const Vec3 gap = tip - touched_.position;
  // Every front has a key of its own, so that it does not begin in the mode of the one before.
  const auto front = static_cast<std::uint64_t>(8 * count_) + static_cast<std::uint64_t>(front_);
  block_ = builder.add<PunctureLaw>(make_key(source_id_, front), params, BlockVector<3>(gap),
                                    PunctureLaw::pressing, {.force = params.puncture_force});
  const Directions world = Mat3::Identity();
  PointJacobian J;
  thread.jacobian(0, J);
  builder.couple(block_, thread, world, J, tip);
  footprint_.couple(builder, block_, tissue, -Mat3::Identity(), tip);
}

void Puncture::commit(const StepContext&, const SolvedBlocks& solved) {
  if (front_ == Front::overrun) {
    ++overruns_;
    begin_bite();
  }
  if (!block_.valid()) presses_ = false;
  if (block_.valid()) commit_front(solved);
  const bool let_out =
      front_ == Front::exit && block_.valid() && solved.mode(block_) == PunctureLaw::penetrated;
  got_out_ = path_->channel().got_out() && !let_out;
  if (got_out_) ++overruns_;
}

std::string Puncture::fault() const {
  if (front_ == Front::overrun) return "the tip got in without a puncture (an overrun)";
  if (got_out_) return "the tip got out without a puncture (an overrun): the step is too long";
  return "";
}

void Puncture::commit_front(const SolvedBlocks& solved) {
  if (solved.mode(block_) != PunctureLaw::penetrated) {
    force_ = touched_.normal.dot(solved.force(block_));
    peak_force_ = std::max(peak_force_, force_);
    lifted_ = !(force_ > 0);
    presses_ = (presses_ || !lifted_) && front_ != Front::layer;
    place_ = front_;
    return;
  }
  presses_ = false;
  force_ = path_->thread().tangent(0, Configuration::current).dot(solved.force(block_));
  // At the end of this step the force is that of the pierced state. The largest one was the
  // threshold, at which the puncture fired.
  peak_force_ = std::max(peak_force_, threshold_here_);
  ++count_;
  Channel& channel = path_->channel();
  switch (front_) {
    case Front::entry:
      begin_bite();
      break;
    case Front::layer:
      channel.record();
      region_ = path_->tissue().region(touched_.at);
      break;
    case Front::exit:
      if (channel.tip_inside()) channel.leave(touched_.at);
      break;
    case Front::none:
    case Front::overrun:
      break;
  }
}

void Puncture::begin_bite() {
  // Beside an old mouth the tip may have slid into that channel in the same step: then the bite has
  // begun already.
  if (!path_->channel().tip_inside()) path_->channel().enter(touched_.at);
  region_ = path_->tissue().region(touched_.at);
}

}  // namespace sutura::suturing
