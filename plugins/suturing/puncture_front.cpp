// What the tip faces at the start of a step, and the place where it presses.
#include <algorithm>
#include <cmath>

#include "puncture.h"

namespace sutura::suturing {
namespace {

// In units of `reach`.
constexpr Real well_inside = 0.01;  // one that is deeper than this has got in
constexpr Real still_there = 1e-3;  // a tip that has slid no further than this has not slid
constexpr Real behind = 0.1;        // from where, behind the tip, the front of a layer is sought
constexpr Real found = 1e-6;        // and to which accuracy
constexpr int looks = 20;           // on that way: a thinner layer than between two is not seen
// A tip without force is free if the surface is no further than so many times its gap.
constexpr Real as_far = 2;

constexpr Real along = 1e-3;  // sine of the angle at which a needle runs along a wall, not at it
constexpr Configuration start = Configuration::start;

}  // namespace

void Puncture::find_front() {
  // It presses from the side on which it is.
  const bool stays = presses_ && place_ != Front::layer &&
                     path_->channel().tip_inside() == (place_ == Front::exit);
  if (stays && keeps_place()) {
    left_ = std::min(left_, overlap());
    return;
  }
  left_ = 0;
  search_front();
  if (front_ == Front::none || front_ == Front::overrun) return;
  lay_footprint();
  if (front_ == Front::layer) return;
  // A single facet may face the tip where the footprint as a whole does not.
  const Vec3 back = path_->thread().tangent(0, start);
  const Real side = front_ == Front::exit ? -1 : 1;
  if (side * footprint_.normal(path_->tissue(), start).dot(back) < along) front_ = Front::none;
  if (front_ == Front::entry) left_ = overlap();
}

/// By how much the tip stands behind the surface that it presses on from outside (m).
Real Puncture::overlap() const {
  const Vec3 tip = path_->thread().point(0, start);
  const Vec3 way = footprint_.position(path_->tissue(), start) - tip;
  return std::max(Real(0), way.dot(footprint_.normal(path_->tissue(), start)));
}

void Puncture::search_front() {
  front_ = Front::none;
  if (!path_->channel().tip_inside()) {
    front_ = find_entry();
  } else if (path_->channel().tip_at_end() || (presses_ && place_ == Front::layer)) {
    // A tip that presses on a layer compresses what is behind it, and with that its own channel.
    front_ = find_exit();
    const Vec3 tip = path_->thread().point(0, start);
    const bool exits = front_ == Front::exit;
    if (find_layer(exits ? (touched_.position - tip).norm() : motion() + reach_))
      front_ = Front::layer;
  }
}

/// A tip that presses keeps its place in the tissue, and where it slides, the place goes along.
/// Sought anew, the tip of a tent would be found now before, now behind one of its few facets, and
/// the tent be let go. False where the tip is free.
bool Puncture::keeps_place() {
  const SolidBody& tissue = path_->tissue();
  const Vec3 tip = path_->thread().point(0, start);
  const Vec3 n = footprint_.normal(tissue, start);
  const Vec3 way = tip - footprint_.position(tissue, start);
  const Real side = place_ == Front::exit ? -1 : 1;
  if (lifted_ && is_free(side * way.dot(n))) return false;

  const Vec3 from = tissue.position(touched_.at, start);
  const bool past = place_ == Front::entry && is_past_edge(n, (tip - from).norm());
  front_ = past ? Front::none : place_;
  const Vec3 slid = way - way.dot(n) * n;
  if (slid.norm() > still_there * reach_) {
    const SurfacePoint before = touched_;
    if (const auto to = tissue.closest_surface(from + slid, 2 * slid.norm(), start, n))
      touched_ = *to;
    footprint_.slide(tissue, before, touched_, tip, pressing(front_, touched_));
  }
  touched_.position = footprint_.position(tissue, start);
  touched_.normal = side * footprint_.normal(tissue, start);
  return true;
}

/// Whether a tip that bears no force is free of its place, and not only shaken for a step: it
/// stands before the surface that a search finds, which is not much further than its place.
/// `above`: how far it stands before its place (m).
bool Puncture::is_free(Real above) {
  if (!(above > 0)) return false;
  const Front before = front_;
  const SurfacePoint pressed = touched_;
  search_front();
  const Vec3 tip = path_->thread().point(0, start);
  const Real distance = (place_ == Front::exit ? -1 : 1) * touched_.distance;
  bool free = false;
  if (front_ == place_)
    free = distance > 0 && distance < as_far * above;
  else if (front_ == Front::overrun)
    free = !path_->tissue().closest_surface(tip, reach_, start);
  else
    free = path_->tissue().locate(tip, start).has_value() == path_->channel().tip_inside();
  front_ = before;
  touched_ = pressed;
  return free;
}

/// Whether the tip has slid past the edge of the surface: the law knows a plane, which goes on
/// there. `normal`: of that plane; `apart`: how far the tip is from its place (m).
bool Puncture::is_past_edge(const Vec3& normal, Real apart) const {
  const SolidBody& tissue = path_->tissue();
  const Vec3 tip = path_->thread().point(0, start), far = (reach_ + apart) * normal;
  if (tissue.crossing(tip + far, tip - far, start, normal)) return false;
  const auto foot = tissue.closest_surface(tip, reach_ + apart, start, normal);
  if (!foot) return true;
  const Vec3 r = tip - foot->position;
  return (r - normal.dot(r) * normal).norm() > path_->thread().radius(0);
}

/// Whether the guess has led the tip through a surface that it did not face. It faces it now.
bool Puncture::meet_on_the_way() {
  const bool inside = path_->channel().tip_inside();
  if (inside && !path_->channel().tip_at_end()) return false;
  const Vec3 tip = path_->thread().point(0, start);
  const Vec3 to = path_->thread().point(0, Configuration::current);
  const Vec3 back = path_->thread().tangent(0, start);
  const auto hit = path_->tissue().crossing(tip, to, start, inside ? Vec3(-back) : back);
  if (!hit || std::abs(hit->normal.dot(back)) < along) return false;
  if (!inside && path_->channel().mouth_near(hit->position)) return false;
  touched_ = *hit;
  if (inside) touched_.normal *= -1;
  front_ = inside ? Front::exit : Front::entry;
  return true;
}

Puncture::Front Puncture::find_entry() {
  const CurveBody& thread = path_->thread();
  const SolidBody& tissue = path_->tissue();
  const Vec3 tip = thread.point(0, start);
  // A tip that presses stands below the surface of the mesh by the dent of its near field.
  const Real dent = footprint_.compliance() * threshold_here_;
  // Only what the needle points at: not the surface it has just left, on the other side of which
  // the next may lie at once (a slit, two lips of a wound).
  const Vec3 back = thread.tangent(0, start);
  const auto hit = tissue.closest_surface(tip, motion() + reach_ + dent, start, back);
  if (path_->channel().mouth_near(tip)) return Front::none;
  const bool deep = !hit || hit->distance < -reach_ - dent;
  if (!deep && is_beyond(*hit)) return Front::none;
  if (!deep && !is_beside(reach_ + dent)) {
    touched_ = *hit;
    return Front::entry;
  }
  if (!is_inside()) return Front::none;
  // An indentation deeper than the elements can follow turns them inside out, and the tip is in
  // without a puncture. Or it has come in through a surface that it does not point at.
  const auto way_in = tissue.closest_surface(tip, thread.length(), start, back);
  touched_ = way_in ? *way_in : *tissue.closest_surface(tip, thread.length(), start);
  return Front::overrun;
}

bool Puncture::is_inside() const {
  const SolidBody& tissue = path_->tissue();
  const Vec3 tip = path_->thread().point(0, start);
  return tissue.locate(tip, start) && !tissue.closest_surface(tip, well_inside * reach_, start);
}

/// Behind a surface that it has not pressed in, and not inside: on the far side of something thin.
bool Puncture::is_beyond(const SurfacePoint& hit) const {
  if (hit.distance > -still_outside * reach_) return false;
  return !path_->tissue().locate(path_->thread().point(0, start), start);
}

/// Whether the tip goes past the edge of the surface, as its first guess says: neither does it
/// stand over it, nor is the surface on its way or where the needle points, up to `reach`.
bool Puncture::is_beside(Real reach) const {
  const CurveBody& thread = path_->thread();
  const SolidBody& tissue = path_->tissue();
  const Vec3 tip = thread.point(0, start);
  const Vec3 to = thread.point(0, Configuration::current);
  const Vec3 back = thread.tangent(0, start);
  const auto meets = [&](const Vec3& from, const Vec3& end) {
    return tissue.crossing(from, end, start, back).has_value();
  };
  if (meets(tip, to) || meets(to + reach * back, to - reach * back)) return false;
  const auto foot = tissue.closest_surface(to, reach, start, back);
  if (!foot) return true;
  const Vec3 r = to - foot->position;
  const Vec3 n = tissue.surface_normal(foot->triangle, start);
  return n.dot(back) <= along || (r - n.dot(r) * n).norm() >= thread.radius(0);
}

Puncture::Front Puncture::find_exit() {
  const CurveBody& thread = path_->thread();
  const SolidBody& tissue = path_->tissue();
  const Vec3 tip = thread.point(0, start);
  const Vec3 forward = -thread.tangent(0, start);
  auto hit = tissue.crossing(tip, tip + (reach_ + motion()) * forward, start, forward);
  // In the step in which it got in, the tip may have gone on through a thin sheet.
  if (!hit && !tissue.locate(tip, start)) hit = tissue.closest_surface(tip, reach_, start, forward);
  if (!hit) return Front::none;
  touched_ = *hit;
  touched_.normal = -hit->normal;
  return Front::exit;
}

/// What the tip would come to if it went through its front now, as far as the tissue springs back
/// over it: where it would come out again, or into the next wall of the same tissue. Those that are
/// known stay; a guess that goes further than the one before may come to more.
void Puncture::find_walls_behind(bool anew) {
  if (anew) walls_behind_ = 0;
  if (front_ != Front::entry && front_ != Front::exit) return;
  const CurveBody& thread = path_->thread();
  const SolidBody& tissue = path_->tissue();
  const Real way = motion();
  if (!anew && way <= sought_) return;
  sought_ = way;
  const Vec3 forward = -thread.tangent(0, start);
  const Vec3 first = tissue.position(touched_.at, start);
  const Real dent = (first - tissue.position(touched_.at, Configuration::rest)).norm();
  const Vec3 to = first + (reach_ + way + dent) * forward;
  for (; walls_behind_ < most_walls; ++walls_behind_) {
    const Wall* before = walls_behind_ > 0 ? &behind_[walls_behind_ - 1] : nullptr;
    Wall& wall = behind_[walls_behind_];
    wall.front = (before ? before->front : front_) == Front::entry ? Front::exit : Front::entry;
    Vec3 from = before ? tissue.position(before->touched.at, start) : first;
    // Two walls that touch may overlap by a little.
    if (wall.front == Front::entry) from -= well_inside * reach_ * forward;
    const Real side = wall.front == Front::exit ? 1 : -1;
    const auto hit = tissue.crossing(from, to, start, side * forward);
    if (!hit) return;
    wall.touched = *hit;
    lay(wall.footprint, wall.front, *hit);
    if (side * wall.footprint.normal(tissue, start).dot(forward) <= along) return;
  }
}

Real Puncture::motion() const {
  const CurveBody& thread = path_->thread();
  return (thread.point(0, Configuration::current) - thread.point(0, start)).norm();
}

/// Whether the tip stands before a layer with a threshold of its own, up to `reach` ahead. The mesh
/// has no surface there: the front is where the region changes along the needle, and its normal is
/// the needle's axis.
bool Puncture::find_layer(Real reach) {
  const SolidBody& tissue = path_->tissue();
  const Vec3 tip = path_->thread().point(0, start);
  const Vec3 forward = -path_->thread().tangent(0, start);
  const auto ahead = [&](Real way) { return tissue.locate(tip + way * forward, start); };
  const auto here = ahead(0);
  if (here && !has_threshold(tissue.region(*here))) region_ = tissue.region(*here);

  // The layer begins ahead: one that the tip has left may lie behind it, or spring back over it.
  constexpr int nowhere = -1;
  const auto region_at = [&](const std::optional<EmbeddedPoint>& p) {
    return p ? tissue.region(*p) : nowhere;
  };
  std::optional<EmbeddedPoint> at;
  Real low = 0, high = -behind * reach_;
  int before = region_at(ahead(high)), next = before;
  const auto is_new = [&] { return next != before && next != region_ && has_threshold(next); };
  for (int k = 1; k <= looks && !is_new(); ++k) {
    before = next;
    low = high;
    high = -behind * reach_ + (reach + behind * reach_) * k / looks;
    at = ahead(high);
    next = region_at(at);
  }
  if (!is_new()) return false;
  while (high - low > found * reach_) {
    const Real middle = 0.5 * (low + high);
    const auto p = ahead(middle);
    const bool is_there = region_at(p) == next;
    if (is_there) at = p;
    (is_there ? high : low) = middle;
  }
  touched_ = {.at = *at,
              .triangle = -1,
              .position = tissue.position(*at, start),
              .normal = -forward,
              .distance = high};
  return true;
}

}  // namespace sutura::suturing
