#include "curve_tool.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sutura::contact {
namespace {

// In units of the radius of the curve.
constexpr Real margin = 1;           // a touch is built from this far, before there is one
constexpr Real clearance = 0.5;      // a centreline may come as near to a surface on its way
constexpr Real arc = clearance / 2;  // so far off its straight way it does not get through
// What a curve may be nearer to the tool than at its touches beside: so much that the normal there
// is turned by `lean` rad, and within these bounds.
constexpr Real least_dip = 1e-5;
constexpr Real dip = 0.05;
constexpr Real lean = 0.003;
// In units of the length of a segment.
constexpr Real at_node = 1e-3;  // this close to a node, the node says the same

constexpr int parts = 8;  // in which a segment is looked at
// Cosine of the angle, 120 degrees, up to which normals are those of sides beside each other.
constexpr Real opposite = -0.5;

/// A convex shape lies behind the plane of its surface that faces `p`: does the way from p to q
/// stay before that plane by `clearance`?
bool stays_off(const ShapeDistance& at_p, const Vec3& p, const Vec3& q, Real clearance) {
  return at_p.distance + std::min(Real(0), at_p.normal.dot(q - p)) >= clearance;
}

}  // namespace

void CurveTool::look() {
  const bool begins_elsewhere = !start_is_known_ || seen_.goes_on || goes_on_;
  seen_.look(curve_, start_is_known_, goes_on_);
  const Pose now = tool_.placed(Configuration::current);
  const Pose start = tool_.placed_without_spin(Configuration::start);
  way_.look(tool_, goes_on_);
  for (CurveSegment& s : seen_.now) s = seen_from(now, s);
  if (!start_is_known_)
    for (CurveSegment& s : seen_.start) s = seen_from(start, s);
  start_is_known_ = true;
  if (begins_elsewhere) look_at_beginning();
}

void CurveTool::look_at_beginning() {
  begin_at_node_.clear();
  begin_room_.clear();
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const CurveSegment& s = seen_.from(i);
    const Real middle = tool_.shape().at((s.xa + s.xb) / 2).distance;
    begin_room_.push_back(middle - MovingCurve::extent(s));
  }
  for (std::size_t node = 0; node <= seen_.size(); ++node) {
    const auto [i, u] = place_of(node);
    begin_at_node_.push_back(tool_.shape().at(u > 0 ? seen_.from(i).xb : seen_.from(i).xa));
  }
}

bool CurveTool::keep() {
  seen_.keep(curve_);
  const Pose now = tool_.placed(Configuration::current);
  for (CurveSegment& s : seen_.guess) s = seen_from(now, s);
  return true;
}

/// What slides round a corner lies on the tool as the step begins, and is at another side of it at
/// the guess. What has gone through, or round the end of a tool or of the curve, comes from
/// elsewhere, or is at the opposite side.
bool CurveTool::may_go_on() const {
  const auto from_tool = [&](const Vec3& p) { return tool_.shape().at(p); };
  return std::all_of(barred_.begin(), barred_.end(), [&](std::size_t i) {
    const CurveSegment &was = seen_.start[i], &is = seen_.now[i];
    const Vec3 middle = (was.xa + was.xb) / 2;
    const Real distance = std::min(
        {from_tool(was.xa).distance, from_tool(middle).distance, from_tool(was.xb).distance});
    return distance < (1 + margin) * was.radius &&
           from_tool(middle).normal.dot(from_tool((is.xa + is.xb) / 2).normal) > opposite;
  });
}

std::pair<std::size_t, Real> CurveTool::place_of(std::size_t node) const {
  const bool is_end = node > 0 && seen_.ends_thick(node - 1);
  return {is_end ? node - 1 : node, is_end ? 1 : 0};
}

void CurveTool::look_for_touches(const TouchedPlaces& before, std::vector<Touch>& out) {
  look();
  begin_look();
  barred_.clear();
  for (std::size_t node = 0; node <= seen_.size(); ++node) find_at_node(node, out);
  for (std::size_t i = 0; i < seen_.size(); ++i) find_inside(i, before, out);
}

/// Nodes are touched where they are: a curve that lies on a surface lies on it along its length.
void CurveTool::find_at_node(std::size_t node, std::vector<Touch>& out) {
  const auto [i, u] = place_of(node);
  if (seen_.now[i].cut) return;
  const Real radius = seen_.now[i].radius;
  const Vec3 from = u > 0 ? seen_.from(i).xb : seen_.from(i).xa;
  const Vec3 to = u > 0 ? seen_.now[i].xb : seen_.now[i].xa;
  const Real motion = (to - from).norm();
  const ShapeDistance& begin = begin_at_node_[node];
  if (begin.distance - motion > (1 + margin) * radius) return;
  const ShapeDistance end = tool_.shape().at(to);
  const bool is_free = stays_off(begin, from, to, clearance * radius) ||
                       stays_off(end, to, from, clearance * radius);
  const Real way = is_free ? 1 : way_through(motion, clearance * radius, [&](Real time) {
    return tool_.shape().at(from + time * (to - from)).distance;
  });
  if (way < 1)
    bar(i, u, way, out);
  else if (end.distance < (1 + margin) * radius)
    out.push_back(touch_at(i, u, tool_.shape().facet(to)));
}

/// A tool does not wait for what is in its way: where that goes back to where it was, it may still
/// be on the wrong side of the tool. So it is touched where the two met, and has to come along.
void CurveTool::bar(std::size_t i, Real u, Real way, std::vector<Touch>& out) {
  free_way_ = std::min(free_way_, way);
  barred_.push_back(i);
  const Vec3 p = seen_.at(i, way).point(u);
  out.push_back(touch_at(i, u, tool_.shape().facet(p)));
}

bool CurveTool::is_far(std::size_t i, Real aside) const {
  return begin_room_[i] - seen_.motion(i) - aside > (1 + margin) * seen_.now[i].radius;
}

Real CurveTool::way_of(std::size_t i, Real more, Lowest& at) const {
  const Real radius = seen_.now[i].radius, near = clearance * radius + more;
  const auto is_free = [&](const CurveSegment& seen) {
    const Vec3 p = seen.point(lowest(seen, radius + more).u);
    const ShapeDistance here = tool_.shape().at(p);
    const Real height = lowest_on_the_way(seen_.from(i), seen_.now[i], here.normal);
    return height - here.normal.dot(p) + here.distance >= near;
  };
  if (is_free(seen_.from(i)) || is_free(seen_.now[i])) return 1;
  return way_through(seen_.motion(i), clearance * radius, [&](Real time) {
    at = lowest(seen_.at(i, time), radius + more);
    return at.distance - more;
  });
}

/// Between nodes, where the curve dips towards the tool: over an edge, round a bend.
void CurveTool::find_inside(std::size_t i, const TouchedPlaces& before, std::vector<Touch>& out) {
  if (seen_.now[i].cut) return;
  const Real aside = way_.bulge(curve_, seen_.from(i), seen_.now[i]);
  if (is_far(i, aside)) return;
  const Real radius = seen_.now[i].radius;
  Lowest at;
  const Real way = way_of(i, 0, at);
  if (way < 1) {
    // The nodes have their own ways.
    if (at.u > 0 && at.u < 1) bar(i, at.u, way, out);
    return;
  }
  if (aside > arc * radius && way_of(i, aside, at) < 1) knows_way_ = false;
  const CurveSegment& s = seen_.now[i];
  std::array<Real, parts + 1> d;
  for (int k = 0; k <= parts; ++k) d[k] = from_tool(s, Real(k) / parts).distance;
  const auto is_near = [&](Real distance) { return distance < (1 + margin) * radius; };
  Real nearest = std::min(d.front(), d.back());
  const auto touch = [&](Real u, Real distance) {
    nearest = std::min(nearest, distance);
    if (is_near(distance)) out.push_back(touch_at(i, u, tool_.shape().facet(s.point(u))));
  };
  // A segment that bulges towards the tool is touched at so many places that the curve dips no
  // further between them. They are fixed on it, so touches are there before it rolls on to them.
  const Real bulge = (d.front() + d.back()) / 2 - d[parts / 2];
  int every = parts;
  for (Real left = bulge; left > dip * radius && every > 1; left /= 4) every /= 2;
  for (int k = every; k < parts; k += every) touch(Real(k) / parts, d[k]);
  // What was touched before is touched again.
  for (Real place = s.abscissa(at_node);;) {
    place = before.between(place, s.abscissa(1 - at_node));
    if (std::isnan(place)) break;
    const Real u = (place - s.from) / s.length(), k = u * parts;
    const bool is_fixed = std::abs(k - std::round(k)) < at_node;
    if (!is_fixed) touch(u, from_tool(s, u).distance);
  }
  for (int k = 1; k < parts; ++k) {
    if (d[k] > d[k - 1] || d[k] >= d[k + 1]) continue;
    const Real u = lowest_between(s, Real(k - 1) / parts, Real(k + 1) / parts, 40);
    const Real here = from_tool(s, u).distance;
    if (u < at_node || u > 1 - at_node || !is_near(here)) continue;
    if (!(here < nearest - dip_at(s, u, here))) continue;
    out.push_back(touch_at(i, u, tool_.shape().facet(s.point(u))));
    out.back().between_nodes = true;
  }
}

/// How much nearer the curve may be at u than where it is touched beside (m). The distance grows by
/// c s^2 / 2 along the curve, and by c' s^2 / 2 along its tangent. So the normal at a touch that is
/// higher by h is turned by c' sqrt(2 h / c), and drags the curve by as much of what presses.
/// A curve that is bent round the tool turns with the normal: no place of it is nearest by much,
/// and any will do. On a flat face the normal is the same everywhere.
Real CurveTool::dip_at(const CurveSegment& s, Real u, Real distance) const {
  constexpr Real crosses = 0.75;
  const Real beside = std::min({u, 1 - u, s.radius / s.length()});
  const Real way = beside * s.length();
  const Vec3 p = s.point(u), tangent = way * s.slope(u).normalized();
  const auto rise = [&](const Vec3& before, const Vec3& after) {
    return tool_.shape().at(before).distance + tool_.shape().at(after).distance - 2 * distance;
  };
  const Real along_curve = rise(s.point(u - beside), s.point(u + beside));
  const Real along_tangent = rise(p - tangent, p + tangent);
  if (!(along_tangent > 0) || along_curve < crosses * along_tangent) return dip * s.radius;
  const Real turned = lean * way / along_tangent;
  return std::clamp(turned * turned * along_curve / 2, least_dip * s.radius, dip * s.radius);
}

CurveTool::Lowest CurveTool::lowest(const CurveSegment& s, Real exact) const {
  Real least = std::numeric_limits<Real>::infinity(), spacing = 0;
  int k = 0;
  Vec3 before = s.point(0);
  for (int j = 0; j <= parts; ++j) {
    const Vec3 p = s.point(Real(j) / parts);
    const Real d = tool_.shape().at(p).distance;
    if (d < least) least = d, k = j;
    spacing = std::max(spacing, (p - before).norm());
    before = p;
  }
  if (least - spacing > exact) return {Real(k) / parts, least - spacing};
  // About a dip the distance is flat: a place to a ten-thousandth of the segment tells it.
  const Real u =
      lowest_between(s, Real(std::max(k - 1, 0)) / parts, Real(std::min(k + 1, parts)) / parts, 12);
  const Real there = from_tool(s, u).distance;
  return there < least ? Lowest{u, there} : Lowest{Real(k) / parts, least};
}

/// Where between two points of a segment, with a dip in between, its slope against the tool is 0.
Real CurveTool::lowest_between(const CurveSegment& s, Real low, Real high, int halvings) const {
  for (int n = 0; n < halvings; ++n) {
    const Real u = (low + high) / 2;
    (from_tool(s, u).normal.dot(s.slope(u)) < 0 ? low : high) = u;
  }
  return (low + high) / 2;
}

/// At its place, as long as that is near the tool.
bool CurveTool::find_again(Real first, Real /*second*/, Touch& touch) const {
  const std::size_t i = seen_.index_at(first);
  const CurveSegment& s = seen_.now[i];
  const Real u = std::clamp((first - s.from) / s.length(), 0., 1.);
  if (!(from_tool(s, u).distance < (1 + margin) * s.radius)) return false;
  touch = touch_at(i, u, tool_.shape().facet(s.point(u)));
  return true;
}

Touch CurveTool::touch_at(std::size_t i, Real u, const Facet& on) const {
  const CurveSegment& s = seen_.now[i];
  const Vec3 p = s.point(u);
  const Real height = on.normal.dot(p - on.foot);
  const Pose frame = tool_.placed(Configuration::current);
  Touch t;
  t.first_place = s.abscissa(u);
  t.normal = frame.rotation * on.normal;
  t.along = frame.rotation * s.slope(u);
  t.second_local = p - height * on.normal;
  t.at = at(frame, t.second_local);
  t.first_arm = -std::max(height, clearance * s.radius) * t.normal;
  t.gap = height - s.radius;
  return t;
}

Real CurveTool::built_from(const Touch& t) const {
  return margin * t.first_arm.norm();
}

Vec3 CurveTool::slip(const Touch& t) const {
  return moved_on(tool_.placed(Configuration::start), tool_.placed(Configuration::current), curve_,
                  t.first_place, t.first_arm);
}

Real CurveTool::rolled(const Touch& t) const {
  return rolled_on(tool_.placed(Configuration::start), tool_.placed(Configuration::current), curve_,
                   t.first_place, t.first_arm);
}

void CurveTool::couple(const Touch& t, BlockId block, const Directions& axes,
                       ConstraintBuilder& builder) const {
  PointJacobian J;
  curve_.surface_jacobian(t.first_place, t.first_arm, J);
  builder.couple(block, curve_, axes, J, t.at);
}

Pair::Tolerance CurveTool::tolerance(const Touch& t) const {
  return {seen_.segment_at(t.first_place).length() / 4, std::numeric_limits<Real>::infinity()};
}

Real CurveTool::distance() const {
  std::vector<CurveSegment> segments;
  curve_.segments(Configuration::current, segments);
  const Pose frame = tool_.placed(Configuration::current);
  Real smallest = std::numeric_limits<Real>::infinity();
  for (const CurveSegment& world : segments) {
    if (world.cut) continue;
    const CurveSegment s = seen_from(frame, world);
    smallest = std::min(smallest, lowest(s, smallest + s.radius).distance - s.radius);
  }
  return smallest;
}

}  // namespace sutura::contact
