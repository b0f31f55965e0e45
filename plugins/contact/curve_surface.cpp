#include "curve_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sutura::contact {
namespace {

// In units of the radius of the curve.
constexpr Real margin = 1;           // a touch is built from this far, before there is one
constexpr Real clearance = 0.5;      // a centreline may come as near to the surface on its way
constexpr Real arc = clearance / 2;  // so far off its straight way it does not get through
constexpr Real dip = 1e-4;           // what a curve may be nearer than at its touches beside
constexpr Real mouth = 3;            // around the mouth of a channel, the channel holds the curve
constexpr Real clear = 0.75;         // of the surface: what is nearer overlaps
constexpr Real stuck = 0.05;         // nearer than that it crosses the surface
constexpr Real taken_back = 0.05;    // of an overlap at the start, in a step
constexpr Real sunk = 1;             // deeper in the surface than at any mouth
constexpr Real point = 6;  // so long is a needle's point, which presses by a law of its own
// In units of the distance at the start.
constexpr Real no_nearer = 0.9;
// In units of the length of a segment.
constexpr Real at_node = 1e-3;  // this close to a node, the node says the same

constexpr int most_handed_over = 3;  // segments beyond the mouth
constexpr int parts = 2;             // chords of a segment
constexpr Real on_border = 1e-9;     // a foot of no more weight at a node is on the opposite edge

/// Is the point of the curve on the outer side of the triangle?
bool is_over(const Vec3& apart, const Corners& c) {
  return apart.dot((c[1] - c[0]).cross(c[2] - c[0])) > 0;
}

}  // namespace

void CurveSurface::look(bool standing) {
  seen_.look(curve_, start_is_known_);
  if (standing) seen_.start = seen_.now;
  start_is_known_ = !standing;
  surface_.look(standing);
  if (const RigidTool* tool = surface_.boundary()->tool()) way_.look(*tool, false);
  inside_.clear();
  if (passage_ != nullptr) passage_->inside(inside_);
  held_ = inside_;
  for (Passage::Stretch& s : inside_) {
    s.low -= mouth * curve_.radius(s.low);
    s.high += mouth * curve_.radius(s.high);
  }
  for (Passage::Stretch& s : inside_) hand_over(s);
  if (passage_ != nullptr) hand_over_ends();
  if (passage_ != nullptr && curve_.needle_length() > 0)
    inside_.push_back({0, point * curve_.radius(0)});
}

/// As the step begins, is a point of segment i nearer to the surface than `part` of its radius?
bool CurveSurface::began_nearer(std::size_t i, Real part) const {
  const CurveSegment& s = seen_.start[i];
  Box box;
  MovingCurve::add_to(box, s);
  Real distance = s.radius;
  surface_.near(box.grown(s.radius), [&](Index t) {
    distance = std::min(distance, closest(s, t, surface_.at(t, 0)).distance);
  });
  return distance < part * s.radius;
}

/// What has just come out of a channel may still be in the surface. It stays with the channel until
/// it is clear: its way would be barred from the start, and a touch would throw it out.
void CurveSurface::hand_over(Passage::Stretch& stretch) {
  const std::size_t n = seen_.size();
  std::size_t first = 0, last = n;
  while (first < n && seen_.now[first].to <= stretch.low) ++first;
  while (last > first && seen_.now[last - 1].from >= stretch.high) --last;
  const auto stays = [this](std::size_t i, int handed_over) {
    return began_nearer(i, handed_over < most_handed_over ? clear : clearance);
  };
  for (int k = 0; first > 0 && stays(first - 1, k); ++k) stretch.low = seen_.now[--first].from;
  for (int k = 0; last < n && stays(last, k); ++k) stretch.high = seen_.now[last++].to;
}

/// Likewise an end that has come out with nothing of the curve left in the channel.
void CurveSurface::hand_over_ends() {
  const std::size_t n = seen_.size();
  std::size_t first = 0, last = n;
  while (first < n && began_nearer(first, clearance)) ++first;
  while (last > first && began_nearer(last - 1, clearance)) --last;
  if (first > 0) inside_.push_back({0, seen_.now[first - 1].to});
  if (last < n) inside_.push_back({seen_.now[last].from, seen_.now[n - 1].to});
}

bool CurveSurface::is_inside(Real low, Real high) const {
  for (const Passage::Stretch& s : inside_)
    if (low < s.high && high > s.low) return true;
  return false;
}

/// How far a segment may be from its straight way seen from the surface (m).
Real CurveSurface::bulge(std::size_t i) const {
  const CurveSegment &is = seen_.now[i], &was = seen_.start[i];
  const RigidTool* tool = surface_.boundary()->tool();
  if (tool == nullptr) return arc_height(seen_.motion(i), turn_of_needle(curve_, was, is));
  return way_.bulge(curve_, seen_from(tool->placed(Configuration::start), was),
                    seen_from(tool->placed(Configuration::current), is));
}

/// May something that turns have gone through, and its straight way beside?
void CurveSurface::doubt(std::size_t i, const Box& box, Real own_motion, const Vec3& common) {
  const Real r = seen_.now[i].radius;
  const Real more = bulge(i);
  if (!(more > arc * r)) return;
  surface_.near(box.grown(clearance * r + more), [&](Index t) {
    const Real motion = own_motion + surface_.motion(t, common);
    const auto distance = [&](Real now) {
      return closest(seen_.at(i, now), t, surface_.at(t, now)).distance - more;
    };
    if (knows_way_ && way_through(motion, clearance * r, distance) < 1) knows_way_ = false;
  });
}

CurveSurface::Near CurveSurface::closest(const CurveSegment& s, Index t, const Corners& at) const {
  Near best;
  best.distance = std::numeric_limits<Real>::infinity();
  for (int k = 0; k < parts; ++k) {
    const Segment chord{s.point(Real(k) / parts), s.point(Real(k + 1) / parts)};
    const SegmentTriangle pair = closest_points(chord, at);
    const Real distance = std::sqrt(pair.squared_distance);
    if (!(distance < best.distance)) continue;
    const Vec3 foot = pair.weights[0] * at[0] + pair.weights[1] * at[1] + pair.weights[2] * at[2];
    best = {t, (k + pair.s) / parts, pair.weights, chord.at(pair.s) - foot, distance};
  }
  // From the chord to the curve, where that matters.
  constexpr Real near = 4;  // radii
  for (int k = 0; k < 8 && best.distance > 0 && best.distance < near * s.radius; ++k) {
    best = closest_to(s, best.u, t, at);
    const Vec3 slope = s.slope(best.u);
    const Real rise = best.apart.dot(slope);
    const Real bend = std::max(slope.squaredNorm() + best.apart.dot(s.second(best.u)),
                               Real(0.1) * slope.squaredNorm());
    const Real u = std::clamp(best.u - rise / bend, 0., 1.);
    if (std::abs(u - best.u) < 1e-9) break;
    const Near next = closest_to(s, u, t, at);
    if (!(next.distance < best.distance)) break;
    best = next;
  }
  return best;
}

CurveSurface::Near CurveSurface::closest_to(const CurveSegment& s, Real u, Index t,
                                            const Corners& at) {
  const Vec3 p = s.point(u);
  const TrianglePoint foot = closest_point(p, at);
  const Vec3 apart = p - foot.on(at);
  return {t, u, foot.weights, apart, apart.norm()};
}

void CurveSurface::look_for_touches(const TouchedPlaces& before, std::vector<Touch>& out) {
  look(false);
  begin_look();
  overlap_at_start_ = 0;
  for (std::size_t i = 0; i < seen_.size(); ++i) meet(i, before, out);
}

void CurveSurface::meet(std::size_t i, const TouchedPlaces& before, std::vector<Touch>& out) {
  const CurveSegment &s = seen_.now[i], &s0 = seen_.start[i];
  const Real r = s.radius;
  if (s.cut || is_inside(s.from, s.to)) return;
  Box box;
  MovingCurve::add_to(box, s), MovingCurve::add_to(box, s0);
  const Vec3 common = s.xa - s0.xa;
  const Real own_motion = seen_.motion(i, common);
  doubt(i, box, own_motion, common);
  around_.clear();
  surface_.near(box.grown((1 + margin) * r), [&](Index t) { around_.push_back(t); });
  if (around_.empty()) return;
  std::sort(around_.begin(), around_.end());  // so that no result hangs on the search

  // Does the way lead through?
  Real free = 1;
  Near met;
  for (const Index t : around_) {
    const Real motion = own_motion + surface_.motion(t, common);
    const auto at = [&](Real now) { return closest(seen_.at(i, now), t, surface_.at(t, now)); };
    // What begins nearer than it may come may go wherever it comes no nearer: barred from the start
    // it would hold up the whole scene, at every step to come. While it overlaps it is a fault.
    const Real start = at(0).distance;
    if (start < clear * r) overlap_at_start_ = std::max(overlap_at_start_, r - start);
    if (start < stuck * r) continue;
    const Real least = std::min(clearance * r, no_nearer * start);
    const Real way =
        way_through(motion, least, [&](Real now) { return now > 0 ? at(now).distance : start; });
    if (way < free) free = way, met = at(way);
  }
  if (free < 1) {
    // A carried surface does not wait for what is in its way: so that is touched where they met.
    free_way_ = std::min(free_way_, free);
    if (met.distance > 0) touch(i, met, out);
    return;
  }

  // At the nodes, once for both segments that share one. What is inside has none.
  Real nearest = std::numeric_limits<Real>::infinity();
  const auto has_node = [&](Real u) {
    if (seen_.has_node(i, u)) return true;
    const CurveSegment& other = seen_.now[u < 1 ? i - 1 : i + 1];
    return is_inside(other.from, other.to);
  };
  for (const Real u : {0., 1.}) {
    sides_of(i, u, sides_);
    for (const Near& side : sides_) {
      nearest = std::min(nearest, side.distance);
      if (has_node(u)) touch(i, side, out);
    }
  }
  // Where it was touched before, and where the surface stands out between.
  for (Real place = s.abscissa(at_node);;) {
    place = before.between(place, s.abscissa(1 - at_node));
    if (std::isnan(place)) break;
    sides_of(i, (place - s.from) / s.length(), sides_);
    for (const Near& side : sides_) {
      nearest = std::min(nearest, side.distance);
      touch(i, side, out);
    }
  }
  Near lowest;
  lowest.distance = std::min((1 + margin) * r, nearest - dip * r);
  for (const Index t : around_) {
    const Near at = closest(s, t, surface_.now(t));
    if (at.distance < lowest.distance && at.u > at_node && at.u < 1 - at_node) lowest = at;
  }
  // What is nearer than it may come sticks in the surface, or is on its way through from inside.
  if (lowest.distance < clearance * r) return;
  if (lowest.triangle < 0) return;
  touch(i, lowest, out);
  out.back().between_nodes = true;
}

/// A foot on an edge or at a node, of which another triangle there is nearer, is none. So a side
/// comes and goes only where its foot leaves its triangle, however the angle between two changes.
/// Nor is one on the far side of something thin.
void CurveSurface::sides_of(std::size_t i, Real u, std::vector<Near>& out) {
  const CurveSegment& s = seen_.now[i];
  const Real reach = (1 + margin) * s.radius;
  feet_.clear();
  for (const Index t : around_)
    if (const Near at = closest_to(s, u, t, surface_.now(t)); at.distance > 0) feet_.push_back(at);
  std::sort(feet_.begin(), feet_.end(), [](const Near& a, const Near& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.triangle < b.triangle;
  });
  out.clear();
  for (auto foot = feet_.begin(); foot != feet_.end() && foot->distance < reach; ++foot) {
    const auto carries = [&](const Near& other) { return is_on(*foot, other.triangle); };
    const auto faces = [&](const Near& other) {
      return carries(other) && is_over(foot->apart, surface_.now(other.triangle));
    };
    if (std::none_of(feet_.begin(), foot, carries) && std::any_of(foot, feet_.end(), faces))
      out.push_back(*foot);
  }
}

/// Is the foot a point of this triangle too?
bool CurveSurface::is_on(const Near& foot, Index triangle) const {
  const auto &own = surface_.nodes(foot.triangle), &nodes = surface_.nodes(triangle);
  for (std::size_t k = 0; k < 3; ++k)
    if (foot.weights[static_cast<Index>(k)] > on_border &&
        std::find(nodes.begin(), nodes.end(), own[k]) == nodes.end())
      return false;
  return true;
}

void CurveSurface::touch(std::size_t i, const Near& at, std::vector<Touch>& out) const {
  const CurveSegment& s = seen_.now[i];
  Touch& t = out.emplace_back();
  t.first_place = s.abscissa(at.u);
  t.triangle = at.triangle;
  t.weights = at.weights;
  t.normal = at.apart / at.distance;
  t.second_place = t.normal.dot(Vec3(1, 2, 4));  // tells the sides of one node apart
  t.along = s.slope(at.u);
  const Corners corners = surface_.now(at.triangle);
  const Vec3 foot =
      at.weights[0] * corners[0] + at.weights[1] * corners[1] + at.weights[2] * corners[2];
  const Vec3 apart = s.point(at.u) - foot;
  const Real height = t.normal.dot(apart);
  t.first_arm = -std::max(height, clearance * s.radius) * t.normal;
  t.at = s.point(at.u) + t.first_arm;
  t.gap = height - s.radius;
  // Taken back at once, a deep overlap would throw the curve about.
  if (t.gap < -taken_back * s.radius) {
    const Near start = closest_to(seen_.start[i], at.u, at.triangle, surface_.at(at.triangle, 0));
    t.left = std::max(Real(0), (1 - taken_back) * s.radius - start.distance);
  }
}

Real CurveSurface::built_from(const Touch& t) const {
  return margin * t.first_arm.norm();
}

Vec3 CurveSurface::slip(const Touch& t) const {
  const Pose still;  // what a triangle turns in a step is small
  return moved_on(still, still, curve_, t.first_place, t.first_arm) -
         surface_.moved(t.triangle, t.weights);
}

Real CurveSurface::rolled(const Touch& t) const {
  const Pose still;
  return rolled_on(still, still, curve_, t.first_place, t.first_arm);
}

void CurveSurface::couple(const Touch& t, BlockId block, const Directions& axes,
                          ConstraintBuilder& builder) const {
  PointJacobian J;
  curve_.surface_jacobian(t.first_place, t.first_arm, J);
  builder.couple(block, curve_, axes, J, t.at);
  surface_.boundary()->couple(builder, block, -axes, t.triangle, t.weights, t.at);
}

Pair::Tolerance CurveSurface::tolerance(const Touch& t) const {
  return {seen_.segment_at(t.first_place).length() / 4, 1};
}

/// What touches have not held apart, and what has come out of its channel and gone into the tissue
/// beside it: surfaces are not met from inside.
Real CurveSurface::unseen_overlap() {
  if (passage_ == nullptr) return overlap_at_start_;
  const auto is_held = [&](const CurveSegment& s) {
    return std::any_of(held_.begin(), held_.end(), [&](const Passage::Stretch& h) {
      const Real more = mouth * s.radius;
      return s.from < h.high + more && s.to > h.low - more;
    });
  };
  Real deepest = overlap_at_start_;
  for (const CurveSegment& s : seen_.now) {
    if (s.cut || is_held(s)) continue;
    for (const Vec3& p : {s.xa, s.xb}) {
      if (!surface_.bounds(p)) continue;
      const Real depth = surface_.boundary()->depth(p);
      if (depth > sunk * s.radius) deepest = std::max(deepest, depth + s.radius);
    }
  }
  return deepest;
}

Real CurveSurface::distance() const {
  CurveSurface now(curve_, surface_.boundary(), passage_);
  now.look(true);
  Real smallest = std::numeric_limits<Real>::infinity();
  for (const CurveSegment& s : now.seen_.now) {
    if (s.cut || now.is_inside(s.from, s.to)) continue;
    for (const Vec3& p : {s.xa, s.xb}) {
      const Real depth = surface_.boundary()->depth(p);
      if (depth > 0) smallest = std::min(smallest, -depth - s.radius);
    }
    Box box;
    MovingCurve::add_to(box, s);
    // Wider and wider, until something is in reach.
    for (Real near = 2 * s.radius; near < 1e3; near *= 4) {
      now.surface_.near(box.grown(near), [&](Index t) {
        smallest = std::min(smallest, closest(s, t, now.surface_.now(t)).distance - s.radius);
      });
      if (smallest < near - s.radius) break;
    }
  }
  return smallest;
}

}  // namespace sutura::contact
