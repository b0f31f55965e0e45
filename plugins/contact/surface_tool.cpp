#include "surface_tool.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sutura/geometry/poses.h"

namespace sutura::contact {
namespace {

// In units of the mean edge of the triangles.
constexpr Real margin = 0.25;  // a touch is built from this far, before there is one
constexpr Real dip = 0.01;     // what a triangle may be nearer than at its nodes
constexpr Real cut = 0.05;     // what an edge may cut into one beside nodes that are pressed
constexpr Real arc = 0.125;    // as little a rim may cut off unseen beside a straight way
constexpr Real depth = 0.25;   // deeper inside than this it is not taken for having come in here
constexpr Real wide = 3;       // of a tool that is wide against the mesh
constexpr Real layers[] = {1e-3, 1e-2, 0.1};  // off a tool with edges, to find how they face it
// Along a capsule a triangle that comes nearer by less than this part of the way is as near all
// along: which point is the nearest hangs on rounding there.
constexpr Real slope = 0.01;
// Nor deeper than this part of the way to the middle of the tool: there another side is nearer.
constexpr Real half_way = 0.5;
constexpr Real unsaid = 0.1;  // deeper no overlap is left without a fault
constexpr Real back = 5e-3;   // of an overlap so much is taken back in a step

Vec3 point(const Vec3& weights, const Corners& c) {
  return weights[0] * c[0] + weights[1] * c[1] + weights[2] * c[2];
}

}  // namespace

Vec3 SurfaceTool::seen(const Vec3& world, Configuration c) const {
  return seen_from(tool_.placed_without_spin(c), world);
}

Corners SurfaceTool::seen_at(Index t, Real time) const {
  Corners from = surface_.at(t, 0), to = surface_.now(t);
  for (std::size_t k = 0; k < 3; ++k) {
    from[k] = seen(from[k], Configuration::start), to[k] = seen(to[k], Configuration::current);
    to[k] = from[k] + time * (to[k] - from[k]);
  }
  return to;
}

/// Projections onto the core of the tool and back onto the triangle: both are convex, so that they
/// close in on the two nearest points. In strides that grow: along nearly parallel sides single
/// ones take hundreds, and what a thin tool is nearer than they say, it goes through unseen.
TrianglePoint SurfaceTool::nearest(const Corners& seen, Real layer, Real worth) const {
  const Shape& shape = tool_.shape();
  const auto to_core = [&](const Vec3& p) { return (shape.core(p, layer) - p).norm(); };
  TrianglePoint best{Vec3::Constant(Real(1) / 3)};
  for (int i = 0; i < 100; ++i) {
    const Vec3 from = best.on(seen);
    best = closest_point(shape.core(from, layer), seen);
    const Vec3 stride = best.on(seen) - from;
    Real least = to_core(best.on(seen));
    if (stride.norm() < 1e-9 * surface_.edge_length() || least == 0) break;
    for (Real length = 2;; length *= 2) {
      const TrianglePoint further = closest_point(from + length * stride, seen);
      const Real distance = to_core(further.on(seen));
      if (!(distance < least - worth * (further.on(seen) - best.on(seen)).norm())) break;
      best = further;
      least = distance;
    }
  }
  return best;
}

/// Of the nearest points of the triangle and of what is left of the tool without as thin a layer as
/// parts the two: where an edge or a corner of the tool presses into the triangle, the nearest of
/// the tool's sides is not what faces it.
SurfaceTool::Facing SurfaceTool::facing(const Corners& seen) const {
  const Shape& shape = tool_.shape();
  Facing out;
  const Real worth = shape.is_round() ? slope : 0;
  for (const Real share : layers) {
    const Real layer = std::min(share * surface_.edge_length(), shape.half_thickness() / 2);
    out.weights = nearest(seen, layer, worth).weights;
    out.point = point(out.weights, seen);
    out.on = shape.facing(out.point, layer);
    if ((out.point - shape.core(out.point, layer)).norm() > 0) break;
  }
  return out;
}

Real SurfaceTool::distance_of(const Corners& seen, Real deepest) const {
  return tool_.shape().at(nearest(seen, deepest, 0).on(seen)).distance;
}

Real SurfaceTool::allowed() const {
  return std::min(depth * surface_.edge_length(), half_way * tool_.shape().half_thickness());
}

template <class At>
Real SurfaceTool::way_of(Real motion, const At& distance) const {
  const Real most = allowed();
  return way_through(motion, most, [&](Real time) { return distance(time) + 2 * most; });
}

void SurfaceTool::look_for_touches(const TouchedPlaces& before, std::vector<Touch>& out) {
  surface_.look();
  way_.look(tool_, false);
  begin_look();
  deepest_ = 0;
  for (std::size_t k = 0; k < surface_.surface_nodes().size(); ++k) find_at_node(k, out);
  if (tool_.shape().kind == Shape::Kind::plane) return;  // nowhere nearer than at a node
  find_lying();
  for (Index t = 0; t < surface_.triangles(); ++t) find_inside(t, before, out);
}

/// A tool does not wait for what is in its way: where that goes back to where it was, it may still
/// be on the wrong side of the tool. So it is touched where the two met, and has to come along.
void SurfaceTool::find_at_node(std::size_t number, std::vector<Touch>& out) {
  const MovingSurface::SurfaceNode& n = surface_.surface_nodes()[number];
  const Vec3 now = surface_.point(n.node);
  const Vec3 from = seen(now - surface_.moved(n.node), Configuration::start);
  const Vec3 to = seen(now, Configuration::current);
  const Real motion = (to - from).norm();
  const Real reach = margin * surface_.edge_length();
  const auto on_the_way = [&](Real time) { return Vec3(from + time * (to - from)); };
  if (tool_.shape().at(from).distance - motion > reach) return;
  // A plane has no other side.
  const Real way = tool_.shape().kind == Shape::Kind::plane ? 1 : way_of(motion, [&](Real time) {
    return tool_.shape().at(on_the_way(time)).distance;
  });
  free_way_ = std::min(free_way_, way);
  if (way < 1 || tool_.shape().at(to).distance < reach)
    touch(static_cast<Real>(n.node), {n.triangle, n.weights}, tool_.shape().facet(on_the_way(way)),
          out);
}

/// A side of the tool lies on a triangle that it presses at all three corners.
void SurfaceTool::find_lying() {
  const Shape& shape = tool_.shape();
  if (shape.is_round()) return;
  lies_at_.assign(static_cast<std::size_t>(surface_.surface_nodes().back().node) + 1, 0);
  for (Index t = 0; t < surface_.triangles(); ++t) {
    const Corners corners = seen_at(t, 1);
    if (std::all_of(corners.begin(), corners.end(), [&](const Vec3& corner) {
          return shape.at(corner).distance <= dip * surface_.edge_length();
        }))
      for (const Index n : surface_.nodes(t)) lies_at_[static_cast<std::size_t>(n)] = 1;
  }
}

void SurfaceTool::find_inside(Index t, const TouchedPlaces& before, std::vector<Touch>& out) {
  const Corners from = seen_at(t, 0), to = seen_at(t, 1);
  const Shape& shape = tool_.shape();
  Real at_nodes = std::numeric_limits<Real>::infinity(), begin = at_nodes, size = 0, motion = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    at_nodes = std::min(at_nodes, shape.at(to[k]).distance);
    begin = std::min(begin, shape.at(from[k]).distance);
    for (const Corners& c : {from, to}) size = std::max(size, (c[(k + 1) % 3] - c[k]).norm());
    motion = std::max(motion, (to[k] - from[k]).norm());
  }
  const Real edge = surface_.edge_length();
  const Real bulge = way_.bulge(from, to);
  if (begin - size - motion - bulge > margin * edge) return;
  const auto at = [&](Real time) { return distance_of(seen_at(t, time), 1.01 * allowed()); };
  const Real way = way_of(motion, at);
  const Corners there = seen_at(t, way);
  const Facing met = facing(there);
  const Vec3& weights = met.weights;
  const Real distance = shape.at(met.point).distance;
  free_way_ = std::min(free_way_, way);
  if (distance < 0) deepest_ = std::max(deepest_, -distance_of(there, 1.01 * allowed()));
  // The numbers of triangles begin after those of nodes. Nodes have ways of their own.
  const Real name = static_cast<Real>(surface_.surface_nodes().back().node + 1 + t);
  constexpr Real at_node = 1 - 1e-6;
  if (way < 1) {
    if (weights.maxCoeff() < at_node) touch(name, {t, weights}, met.on, out);
    return;
  }
  if (bulge > arc * edge && way_of(motion, [&](Real time) { return at(time) - bulge; }) < 1)
    knows_way_ = false;
  if (distance > margin * edge) return;
  // Where a side of the tool lies on the surface, its rim always cuts a little into the triangles
  // around, and holding them there would make a punch wider than it is: only what tilts over an
  // edge cuts in deeper. Beside single nodes the rim itself is what presses, and left in there it
  // would stay inside, resting on these nodes alone.
  // A wide round tool cuts into all triangles, by a sixth of the square of the edge over its
  // radius. There nodes are enough: a touch between them would move by that radius as the triangle
  // tilts, and passes to and fro.
  const bool is_cut = distance < std::min(Real(0), at_nodes) - cut * edge;
  const bool is_between = shape.is_round() ? shape.radius < wide * edge : !lies_beside(t) || is_cut;
  const bool was_touched = !std::isnan(before.between(name - 0.5, name + 0.5));
  if (!is_between || !(was_touched || distance < at_nodes - dip * edge)) return;
  touch(name, {t, weights}, met.on, out);
  leave(from, out.back());
}

/// Around nodes that are pressed a rim cuts into triangles that are not touched, and a triangle
/// that is touched is so at another point in every pass. What it overlaps as the step begins is no
/// work that the step has to do: it is left, but for so much that what steps miss does not add up.
void SurfaceTool::leave(const Corners& before, Touch& t) const {
  const Facing deepest = facing(before);
  const Vec3 normal = tool_.placed(Configuration::current).rotation.conjugate() * t.normal;
  const Real height = normal.dot(point(t.weights, before) - t.second_local) + t.gap;
  const Real overlap = -std::max(deepest.on.normal.dot(deepest.point - deepest.on.foot), height);
  t.left = std::max(Real(0), overlap - back * surface_.edge_length());
}

void SurfaceTool::touch(Real name, const Place& place, const Facet& on,
                        std::vector<Touch>& out) const {
  const Pose frame = tool_.placed(Configuration::current);
  const Corners c = surface_.now(place.triangle);
  const Vec3 p = point(place.weights, c);
  Touch& t = out.emplace_back();
  t.first_place = name;
  t.triangle = place.triangle;
  t.weights = place.weights;
  t.normal = frame.rotation * on.normal;
  t.along = t.normal.unitOrthogonal();
  t.at = p;
  t.second_local = seen_from(frame, p);
  t.gap = on.normal.dot(t.second_local - on.foot);
}

Real SurfaceTool::built_from(const Touch&) const {
  return margin * surface_.edge_length();
}

Vec3 SurfaceTool::slip(const Touch& t) const {
  return surface_.moved(t.triangle, t.weights) - tool_.moved(t.second_local);
}

void SurfaceTool::couple(const Touch& t, BlockId block, const Directions& axes,
                         ConstraintBuilder& builder) const {
  surface_.boundary()->couple(builder, block, axes, t.triangle, t.weights, t.at);
}

Pair::Tolerance SurfaceTool::tolerance(const Touch&) const {
  return {0.5, std::numeric_limits<Real>::infinity()};
}

Real SurfaceTool::unseen_overlap() {
  return deepest_ > unsaid * surface_.edge_length() ? deepest_ : 0;
}

Real SurfaceTool::distance() const {
  SurfaceTool now(surface_.boundary(), tool_);
  now.surface_.look(true);
  const Shape& shape = tool_.shape();
  Real smallest = std::numeric_limits<Real>::infinity();
  for (const MovingSurface::SurfaceNode& n : now.surface_.surface_nodes()) {
    const Vec3 p = seen(now.surface_.point(n.node), Configuration::current);
    smallest = std::min(smallest, shape.at(p).distance);
  }
  if (shape.kind == Shape::Kind::plane) return smallest;
  for (Index t = 0; t < now.surface_.triangles(); ++t) {
    Corners c = now.surface_.now(t);
    for (Vec3& p : c) p = seen(p, Configuration::current);
    const Real size = std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
    if (shape.at(c[0]).distance - size >= smallest) continue;
    // Of two that are apart, and of two of which one is deep in the other.
    smallest = std::min({smallest, shape.at(now.facing(c).point).distance,
                         distance_of(c, shape.half_thickness() / 2)});
  }
  // No surface may be near a tool that is inside.
  const Real inside = now.surface_.boundary()->depth(tool_.placed(Configuration::current).position);
  return inside > 0 ? std::min(smallest, -inside - shape.half_thickness()) : smallest;
}

}  // namespace sutura::contact
