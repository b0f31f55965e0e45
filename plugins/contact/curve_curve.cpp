#include "curve_curve.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "bulge.h"
#include "common_turn.h"

namespace sutura::contact {
namespace {

// In units of the sum of the two radii.
constexpr Real margin = 0.5;         // a touch is built from this far, before there is one
constexpr Real node_margin = 0.25;   // and at nodes of strands that run along each other
constexpr Real clearance = 0.5;      // centrelines may come as near to each other on their ways
constexpr Real folded = 0.9;         // or by a tenth, where they begin nearer than that
constexpr Real arc = clearance / 2;  // so far off its straight way none gets through
constexpr Real nearer = 1e-3;        // by more than at the touches beside: there is one too
constexpr Real dip = 0.05;           // so much of an overlap a step takes back
// In units of the length of a segment.
constexpr Real at_node = 1e-3;  // this close to a node, the node says the same
constexpr Real doubles = 0.05;  // touches closer than this on both are one
// Strands cross where the distance grows faster than this (`sharpness`): straight ones from 30
// degrees on.
constexpr Real crossing = 0.25;
// Between two points that touch a strand must turn by pi, at least; less what segments hide.
constexpr Real least_turn = 2.5;

/// Two pieces of a thread that is cut may meet however straight they are.
Real turn(const CurveSegment& s) {
  if (s.cut) return 2 * std::numbers::pi;
  const auto angle = [](const Vec3& a, const Vec3& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
  };
  const Vec3 chord = s.xb - s.xa;
  return angle(s.ma, chord) + angle(chord, s.mb);
}

/// By how much more a segment may turn on its way than at its ends: where its slope goes from one
/// direction to another by the angle p, it is as short as cos(p / 2) half way. Only of those that
/// go far about; one that is turned round goes through itself.
Real turn_on_the_way(const CurveSegment& start, const CurveSegment& now) {
  constexpr Real far = 0.5, least = 1e-3;  // cosines
  const auto cosine = [](const Vec3& a, const Vec3& b) { return a.dot(b) / (a.norm() * b.norm()); };
  const Real turned = std::min(cosine(start.ma, now.ma), cosine(start.mb, now.mb));
  if (!(turned < far)) return 1;
  return 1 / std::max(least, std::sqrt((1 + turned) / 2));
}

Real reach(const CurveSegment& a, const CurveSegment& b) {
  return a.radius + b.radius;
}

/// With rho the radius of curvature towards the other strand, at the distance d: 1 / (rho - d), the
/// second derivative of the distance as the other moves along this one; 0 where it is bent away.
Real bend(const CurveSegment& s, Real u, const Vec3& towards, Real distance) {
  const Real speed = s.slope(u).squaredNorm();
  const Real curvature = towards.dot(s.second(u)) / speed;
  constexpr Real tightest = 0.9;  // a strand that is bent as tight as it is thick has no limit
  if (!(curvature > 0)) return 0;
  return curvature / (1 - std::min(curvature * distance, tightest));
}

/// How fast the distance grows along `a` from the nearest place: by s^2 / (2 d) times this. For
/// straight strands it is the square of the sine between them. It is less where one is bent round
/// the other, as in a tight knot, whatever the angle.
Real sharpness(const CurveSegment& a, const CurveSegment& c, const ClosestPair& at) {
  const Real d = at.distance, cosine = a.slope(at.u).normalized().dot(c.slope(at.v).normalized());
  const Vec3 n = at.apart / d;
  return 1 / (1 + d * bend(a, at.u, -n, d)) - cosine * cosine * (1 + d * bend(c, at.v, n, d));
}

/// Cosine between the way from one place to the other and the tangent t of one of the strands.
Real slope(const ClosestPair& at, const Vec3& t) {
  return at.apart.dot(t) / (at.distance * t.norm());
}

/// Height of `a` over `b` along n: no point of one is closer than that to any of the other.
Real height_between(const CurveSegment& a, const CurveSegment& b, const Vec3& n) {
  Vec3 p[4], q[4];
  MovingCurve::hull(a, p), MovingCurve::hull(b, q);
  Real low = n.dot(p[0]), high = n.dot(q[0]);
  for (int k = 1; k < 4; ++k) low = std::min(low, n.dot(p[k])), high = std::max(high, n.dot(q[k]));
  return low - high;
}

}  // namespace

void CurveCurve::look() {
  a_.look(first_, start_is_known_);
  tree_a_.fit(a_);
  if (is_self_) {
    if (!start_is_known_) look_at_start();
    add_up_turns();
  } else {
    b_.look(second_, start_is_known_);
    tree_b_.fit(b_);
  }
  start_is_known_ = true;
}

void CurveCurve::look_at_start() {
  start_turn_.clear();
  for (const CurveSegment& s : a_.start) start_turn_.push_back(turn(s));
}

void CurveCurve::add_up_turns() {
  turned_.resize(a_.size() + 1);
  turned_[0] = 0;
  for (std::size_t i = 0; i < a_.size(); ++i)
    turned_[i + 1] = turned_[i] + std::max(start_turn_[i], turn(a_.now[i])) *
                                      turn_on_the_way(a_.start[i], a_.now[i]);
}

bool CurveCurve::are_apart(std::size_t i, std::size_t j) const {
  const Real arc = a_.now[j].from - a_.now[i].to;
  return arc > 0 && turned_[j + 1] - turned_[i] > least_turn &&
         a_.now[j].to - a_.now[i].from > std::numbers::pi * a_.now[i].radius;
}

template <class Meet>
void CurveCurve::each_pair(std::size_t i, std::size_t j, Real near, const Meet& found) const {
  const CurveTree::Span p = tree_a_.span(i), q = tree_b().span(j);
  if (p.begin == p.end || q.begin == q.end) return;
  // Nothing on this stretch turns far enough to meet itself.
  if (is_self_ && turned_[q.end] - turned_[p.begin] <= least_turn) return;
  if (!CurveTree::may_meet(tree_a_, i, tree_b(), j, near)) return;
  const bool a_is_leaf = i >= tree_a_.first_leaf(), b_is_leaf = j >= tree_b().first_leaf();
  if (a_is_leaf && b_is_leaf) {
    if (!is_self_ || (i < j && are_apart(p.begin, q.begin))) found(p.begin, q.begin);
  } else if (is_self_ && i == j) {
    each_pair(2 * i, 2 * i, near, found);
    each_pair(2 * i, 2 * i + 1, near, found);
    each_pair(2 * i + 1, 2 * i + 1, near, found);
  } else if (b_is_leaf || (!a_is_leaf && p.end - p.begin >= q.end - q.begin)) {
    each_pair(2 * i, j, near, found);
    each_pair(2 * i + 1, j, near, found);
  } else {
    each_pair(i, 2 * j, near, found);
    each_pair(i, 2 * j + 1, near, found);
  }
}

void CurveCurve::look_for_touches(const TouchedPlaces& before, std::vector<Touch>& out) {
  look();
  begin_look();
  Real widest = 0;
  for (const CurveSegment& s : a_.now) widest = std::max(widest, s.radius);
  for (const CurveSegment& s : b().now) widest = std::max(widest, s.radius);
  const std::size_t from = out.size();
  each_pair(1, 1, 2 * margin * widest + needle_arc(),
            [&](std::size_t i, std::size_t j) { meet(i, j, before, out); });
  drop_doubles(out, from);
}

/// No needle is further from its straight way, seen from what rests (m).
Real CurveCurve::needle_arc() const {
  Real most = 0;
  const auto look_at = [&](const MovingCurve& curve, const CurveBody& of) {
    for (std::size_t i = 0; i < curve.size() && curve.now[i].from < of.needle_length(); ++i)
      most = std::max(
          most, arc_height(curve.motion(i), turn_of_needle(of, curve.start[i], curve.now[i])));
  };
  look_at(a_, first_);
  if (!is_self_) look_at(b_, second_);
  return most;
}

bool CurveCurve::is_lowest(Real u, Real slope, const MovingCurve& curve, std::size_t segment) {
  constexpr Real rounding = 1e-9;
  if (u <= 0) return curve.begins_thick(segment) || std::abs(slope) < rounding;
  if (u >= 1) return curve.ends_thick(segment);  // else the next one has it at its u = 0
  return true;
}

void CurveCurve::meet(std::size_t i, std::size_t j, const TouchedPlaces& before,
                      std::vector<Touch>& out) {
  const CurveSegment &a = a_.now[i], &c = b().now[j];
  if (is_self_ && a.rigid >= 0 && a.rigid == c.rigid) return;
  const CurveSegment &a0 = a_.start[i], &c0 = b().start[j];
  const Real R = reach(a, c);
  const Vec3 common = (a.xa - a0.xa + c.xa - c0.xa) / 2;
  const Real motion = a_.motion(i, common) + b().motion(j, common);
  const Real middles = ((a0.xa + a0.xb - c0.xa - c0.xb) / 2).norm();
  if (middles - MovingCurve::extent(a0) - MovingCurve::extent(c0) - motion > (1 + margin) * R)
    return;

  const Real fine = R;
  const auto is_free = [&](const ClosestPair& at) {
    if (!(at.distance >= clearance * R)) return false;
    const Vec3 n = at.apart / at.distance;
    return height_between(a0, c0, n) >= clearance * R && height_between(a, c, n) >= clearance * R;
  };
  ClosestPair end = closest_on(a, c, fine);
  if (!is_free(end)) {
    ClosestPair at = closest_on(a0, c0, fine);
    if (!is_free(at)) {
      // What a thread folds to within one bend of it counts as two strands only once it has turned
      // far enough, and may be nearer than that by then.
      const Real least = std::min(clearance * R, folded * at.distance);
      const Real way = way_through(motion, least, [&](Real t) {
        at = closest_on(a_.at(i, t), b().at(j, t), fine);
        return at.distance;
      });
      free_way_ = std::min(free_way_, way);
      if (way < 1) return;
    }
  }
  const Real turn = turn_of_needle(first_, a0, a) + turn_of_needle(second_, c0, c);
  const Real aside = turn > 0 ? arc_height(motion, turn) : 0;
  if (knows_way_ && aside > arc * R) {
    const auto distance = [&](Real t) {
      return closest_on(a_.at(i, t), b().at(j, t), R + aside).distance - aside;
    };
    if (way_through(motion, clearance * R, distance) < 1) knows_way_ = false;
  }
  if (end.distance > (1 + margin) * R) return;

  const auto is_on_b = [&](const ClosestPair& at) {
    return is_lowest(at.v, slope(at, c.slope(at.v)), b(), j);
  };
  // Strands along each other touch at the nodes of the first. Those that cross do not: the normal
  // at a node beside the nearest place leans along the strand, and the node is a bead in its way.
  Real nearest = std::numeric_limits<Real>::infinity();
  const bool is_along = !(sharpness(a, c, end) > crossing);
  for (const Real u : {0., 1.}) {
    if (!is_along) break;
    const ClosestPair at = closest_to(a.point(u), u, c);
    if (!is_on_b(at)) continue;
    nearest = std::min(nearest, at.distance);
    if (a_.has_node(i, u) && at.distance < (1 + node_margin) * R) out.push_back(touch_at(i, j, at));
  }
  for (Real place = a.abscissa(at_node); is_along;) {
    place = before.between(place, a.abscissa(1 - at_node));
    if (std::isnan(place)) break;
    const Real u = (place - a.from) / a.length();
    const ClosestPair at = closest_to(a.point(u), u, c);
    if (!is_on_b(at) || at.distance > (1 + margin) * R) continue;
    nearest = std::min(nearest, at.distance);
    out.push_back(touch_at(i, j, at));
  }
  const bool is_on_a = is_lowest(end.u, slope(end, a.slope(end.u)), a_, i);
  // Where strands are deep in each other the nearest place always is a touch: beside one that is
  // pushed apart they may come closer.
  const bool is_deep = end.distance < (1 - 2 * dip) * R;
  if (!is_on_a || !is_on_b(end) || !(is_deep || end.distance < nearest - nearer * R)) return;
  out.push_back(touch_at(i, j, end));
  out.back().between_nodes = true;
}

/// At the place of the first, wherever on the segments about that of the second is nearest to it.
bool CurveCurve::find_again(Real first, Real second, Touch& touch) const {
  if (are_one(first, second)) return false;
  const std::size_t i = a_.index_at(first), near = b().index_at(second);
  const CurveSegment& a = a_.now[i];
  const Real u = std::clamp((first - a.from) / a.length(), 0., 1.);
  ClosestPair nearest;
  nearest.distance = std::numeric_limits<Real>::infinity();
  std::size_t on = near;
  for (std::size_t j = near - (near > 0); j <= near + 1 && j < b().size(); ++j) {
    if (is_self_ && !are_apart(i, j)) continue;
    const CurveSegment& c = b().now[j];
    const ClosestPair at = closest_to(a.point(u), u, c);
    if (at.distance < nearest.distance && is_lowest(at.v, slope(at, c.slope(at.v)), b(), j))
      nearest = at, on = j;
  }
  if (!(nearest.distance < (1 + margin) * reach(a, b().now[on]))) return false;
  touch = touch_at(i, on, nearest);
  return true;
}

/// Of what segments overlap as the step begins, a step takes back so much and leaves the rest:
/// taken back at once, a deep overlap would throw the strands about.
Real CurveCurve::left_of_overlap(std::size_t i, std::size_t j, Real reach) const {
  const Real overlap = reach - closest_on(a_.start[i], b().start[j], reach).distance;
  return std::max(Real(0), overlap - dip * reach);
}

Touch CurveCurve::touch_at(std::size_t i, std::size_t j, const ClosestPair& at) const {
  const CurveSegment &a = a_.now[i], &c = b().now[j];
  const Real R = reach(a, c);
  Touch t;
  t.first_place = a.abscissa(at.u);
  t.second_place = c.abscissa(at.v);
  t.normal = at.apart / at.distance;
  t.along = a.slope(at.u);
  t.first_arm = -at.apart * (a.radius / R);
  t.second_arm = at.apart * (c.radius / R);
  t.at = a.point(at.u) + t.first_arm;
  t.gap = at.distance - R;
  if (t.gap < -dip * R) t.left = left_of_overlap(i, j, R);
  // Signs so that a strand that is bent round the other has a positive radius.
  t.first_bend = bend(a, at.u, -t.normal, at.distance);
  t.second_bend = bend(c, at.v, t.normal, at.distance);
  t.first_tangent = t.along.normalized();
  t.second_tangent = c.slope(at.v).normalized();
  return t;
}

/// At a node, two segments may have found one and the same place. The nearer one stays.
void CurveCurve::drop_doubles(std::vector<Touch>& touches, std::size_t from) {
  const auto first = touches.begin() + static_cast<std::ptrdiff_t>(from);
  std::sort(first, touches.end(), [](const Touch& p, const Touch& q) {
    return p.first_place != q.first_place ? p.first_place < q.first_place
                                          : p.second_place < q.second_place;
  });
  std::size_t kept = from;
  for (std::size_t k = from; k < touches.size(); ++k) {
    bool is_double = false;
    const Touch& t = touches[k];
    const Real near = doubles * (t.first_arm.norm() + t.second_arm.norm());
    for (std::size_t m = kept; m-- > from && !is_double;) {
      if (t.first_place - touches[m].first_place > near) break;
      is_double = std::abs(t.second_place - touches[m].second_place) <= near;
    }
    if (!is_double) touches[kept++] = t;
  }
  touches.resize(kept);
}

Real CurveCurve::built_from(const Touch& t) const {
  return margin * (t.first_arm.norm() + t.second_arm.norm());
}

Vec3 CurveCurve::slip(const Touch& t) const {
  const SectionMotion a(first_, t.first_place), b(second_, t.second_place);
  // Seen from a partner that turns with both: what they roll counts against that.
  const Real reach = t.first_arm.norm() + t.second_arm.norm();
  const Pose start{Vec3::Zero(), Quat::Identity()},
      now{Vec3::Zero(), common_turn(a.was, a.is, b.was, b.is, reach)};
  return moved_on(start, now, first_, t.first_place, a, t.first_arm) -
         moved_on(start, now, second_, t.second_place, b, t.second_arm);
}

void CurveCurve::couple(const Touch& t, BlockId block, const Directions& axes,
                        ConstraintBuilder& builder) const {
  PointJacobian J;
  first_.surface_jacobian(t.first_place, t.first_arm, J);
  builder.couple(block, first_, axes, J, t.at);
  second_.surface_jacobian(t.second_place, t.second_arm, J);
  builder.couple(block, second_, -axes, J, t.at);
}

void CurveCurve::couple_shift(const Touch& t, bool of_first, BlockId block, const Vec3& direction,
                              ConstraintBuilder& builder) const {
  const SegmentedCurve &shifted = of_first ? first_ : second_, &other = of_first ? second_ : first_;
  const Real at = of_first ? t.first_place : t.second_place;
  const Real beside = of_first ? t.second_place : t.first_place;
  const Vec3 between = t.second_arm - t.first_arm;  // centre of the first from that of the second
  PointJacobian J;
  // Of the centreline: a strand that rolls turns no normal.
  shifted.jacobian(at, J);
  builder.couple(block, shifted, direction.transpose(), J, t.at);
  other.surface_jacobian(beside, of_first ? between : Vec3(-between), J);
  builder.couple(block, other, -direction.transpose(), J, t.at);
}

Pair::Tolerance CurveCurve::tolerance(const Touch& t) const {
  const auto length = [](const MovingCurve& curve, Real s) {
    const CurveSegment& segment = curve.segment_at(s);
    return segment.length() + 2 * segment.radius;
  };
  return {length(a_, t.first_place) / 4, length(b(), t.second_place) / 2};
}

bool CurveCurve::are_one(Real first, Real second) const {
  const Index body = a_.segment_at(first).rigid;
  return is_self_ && body >= 0 && body == a_.segment_at(second).rigid;
}

Real CurveCurve::distance() const {
  CurveCurve now(first_, second_);
  first_.segments(Configuration::current, now.a_.now);
  now.a_.start = now.a_.now;
  now.tree_a_.fit(now.a_);
  if (is_self_) {
    now.look_at_start();
    now.add_up_turns();
  }
  second_.segments(Configuration::current, now.b_.now);
  now.b_.start = now.b_.now;
  now.tree_b_.fit(now.b_);
  Real smallest = std::numeric_limits<Real>::infinity();
  // Wider and wider, until something is in reach.
  Real size = 0;
  for (const CurveSegment& s : now.a_.now) size = std::max(size, s.radius);
  for (Real near = size; near < 1e3 && !(smallest < near); near *= 4)
    now.each_pair(1, 1, near, [&](std::size_t i, std::size_t j) {
      const CurveSegment &a = now.a_.now[i], &c = now.b().now[j];
      smallest = std::min(smallest, closest_on(a, c, reach(a, c)).distance - reach(a, c));
    });
  return smallest;
}

}  // namespace sutura::contact
