#include "surface_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "moving_curve.h"
#include "sutura/geometry/poses.h"

namespace sutura::contact {
namespace {

// In units of the mean edge of the triangles.
constexpr Real depth = 0.5;      // a node that has come through is found so far behind a triangle
constexpr Real margin = 0.25;    // a touch is built from this far, before there is one
constexpr Real beside = 0.1;     // a node may stand so far beside a triangle
constexpr Real arc = 0.125;      // as little a rim may cut off unseen beside a straight way
constexpr Real seen = 0.1;       // deeper than this no overlap is left without a fault
constexpr Real rounding = 1e-3;  // as far behind a triangle a node counts as being on it
// Nor deeper than this part of the way through: there the other side is nearer.
constexpr Real half_way = 0.5;
// Cosine between the normal of a triangle and that of a node that faces it, at most.
constexpr Real facing = -0.2;
// Cosine between the normals of two walls that lie on each other, at most: 26 degrees.
constexpr Real closed = -0.9;

/// Of two triangles (m).
Real distance_between(const Corners& a, const Corners& b) {
  Real least = std::numeric_limits<Real>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    least = std::min({least, closest_points(Segment{a[k], a[next]}, b).squared_distance,
                      closest_points(Segment{b[k], b[next]}, a).squared_distance});
  }
  return std::sqrt(least);
}

}  // namespace

Real SurfaceSurface::edge_length() const {
  if (second().boundary()->is_rigid()) return first_.edge_length();
  return std::min(first_.edge_length(), second().edge_length());
}

Real SurfaceSurface::deepest(const MovingSurface& faces, Index triangle) const {
  return std::min(depth * edge_length(), half_way * faces.thickness(triangle));
}

void SurfaceSurface::look(bool standing) {
  if (first_.look(standing)) normals_first_.look(first_);
  if (!is_self_ && second_.look(standing)) normals_second_.look(second_);
}

void SurfaceSurface::look_for_touches(const TouchedPlaces& before, std::vector<Touch>& out) {
  begin_look();
  look(false);
  const Real reach = margin * edge_length();
  const std::size_t others = out.size();
  meet(false, reach, before, out);
  if (second().boundary()->is_rigid()) held_.look(first_, std::span(out).subspan(others));
  if (!is_self_) meet(true, reach, before, out);
  drop_doubles(out);
  meet_edges(reach, out);
  if (free_way_ == 1) doubt();
}

/// May a tool that turns have gone through, and its straight way beside?
void SurfaceSurface::doubt() {
  const RigidTool* tool = second().boundary()->tool();
  if (tool == nullptr) return;
  way_.look(*tool, false);
  const Pose start = tool->placed(Configuration::start), end = tool->placed(Configuration::current);
  for (Index t = 0; t < first_.triangles() && knows_way_; ++t) {
    Corners from = first_.at(t, 0), to = first_.now(t);
    Box box;
    for (std::size_t k = 0; k < 3; ++k) {
      box.add(from[k]), box.add(to[k]);
      from[k] = seen_from(start, from[k]), to[k] = seen_from(end, to[k]);
    }
    const Real more = way_.bulge(from, to);
    if (!(more > arc * edge_length())) continue;
    const Vec3 common = first_.moved(first_.nodes(t)[0]);
    second().near(box.grown(more), [&](Index other) {
      const Real motion = first_.motion(t, common) + second().motion(other, common);
      const auto room = [&](Real time) {
        return distance_between(first_.at(t, time), second().at(other, time)) - more;
      };
      const Real near = rounding * edge_length();
      if (knows_way_ && way_through(motion, near, room) < 1) knows_way_ = false;
    });
  }
}

void SurfaceSurface::meet(bool nodes_are_second, Real reach, const TouchedPlaces& before,
                          std::vector<Touch>& out) {
  const Real around = std::max(reach, depth * edge_length());
  const bool faces_are_second = !is_self_ && !nodes_are_second;
  NearTriangles& near = nodes_are_second ? near_second_ : near_first_;
  const Search search{nodes_are_second ? second() : first_,
                      nodes_are_second ? first_ : second(),
                      nodes_are_second ? normals_second_ : normals_first_,
                      faces_are_second ? normals_second_ : normals_first_,
                      near,
                      before,
                      nodes_are_second,
                      reach,
                      around};
  near.look(search.nodes, search.faces, around);
  for (std::size_t place = 0; place < search.nodes.surface_nodes().size(); ++place)
    meet_node(search, place, out);
}

void SurfaceSurface::meet_node(const Search& search, std::size_t place, std::vector<Touch>& out) {
  const MovingSurface &nodes = search.nodes, &faces = search.faces;
  const MovingSurface::SurfaceNode& n = nodes.surface_nodes()[place];
  if (search.near.of(place).empty()) return;
  Seeker seeker{nodes.point(n.node), search.node_normals.of_node(nodes, n), std::nullopt};
  const Real away = turned_away(search, n, seeker.outward);
  near_.clear();
  Passing first;
  Near best;
  for (const Index t : search.near.of(place)) {
    const Vec3& normal = search.face_normals.now(t);
    if (normal.dot(seeker.outward) > away) continue;
    const bool is_facing = normal.dot(seeker.outward) <= facing;
    if (!is_facing && !faces_a_side(search, n, normal)) continue;
    const Passing through = passing(nodes, n.node, faces, t);
    if (through.free < first.free) {
      first = through;
      best = {t, through.weights, 0};
    }
    if (first.free == 1 && is_facing) add_near(search, n.node, t, seeker);
  }
  if (first.free == 1 && near_.empty()) return;
  if (is_self_ && ends_a_cut(search, n)) return;
  free_way_ = std::min(free_way_, first.free);
  if (first.free == 1) best = nearest();

  touch(search, n, seeker.at, best, out);
  if (first.free < 1) return;
  for (const Near& on : near_)
    if (make_valley(search, best.triangle, on.triangle)) touch(search, n, seeker.at, on, out);
}

void SurfaceSurface::touch(const Search& search, const MovingSurface::SurfaceNode& n,
                           const Vec3& at, const Near& on, std::vector<Touch>& out) {
  const Corners c = search.faces.now(on.triangle);
  const Vec3& normal = search.face_normals.now(on.triangle);
  Touch& t = out.emplace_back();
  t.triangle = on.triangle;
  t.weights = on.weights;
  t.normal = search.nodes_are_second ? Vec3(-normal) : normal;
  t.along = t.normal.unitOrthogonal();
  t.at = on.weights[0] * c[0] + on.weights[1] * c[1] + on.weights[2] * c[2];
  t.gap = normal.dot(at - t.at);
  t.node = n.node;
  t.node_triangle = n.triangle;
  t.node_weights = n.weights;
  t.nodes_are_second = search.nodes_are_second;
  t.first_place = place_of(search, n.node);
  t.second_place = static_cast<Real>(on.triangle);
}

/// Is each of two triangles in front of the other? Then a node between them is held by both: the
/// nearer one alone would lead it into the other, and that one back, from pass to pass.
bool SurfaceSurface::make_valley(const Search& search, Index one, Index other) const {
  const Real flat = rounding * edge_length();
  const auto is_in_front = [&](Index triangle, Index of) {
    const Vec3& normal = search.face_normals.now(of);
    const Vec3 on = search.faces.now(of)[0];
    Real highest = 0;
    for (const Vec3& corner : search.faces.now(triangle)) {
      const Real height = normal.dot(corner - on);
      if (height < -flat) return false;
      highest = std::max(highest, height);
    }
    return highest > flat;
  };
  return one != other && is_in_front(one, other) && is_in_front(other, one);
}

Real SurfaceSurface::place_of(const Search& search, Index node) {
  return static_cast<Real>(search.nodes_are_second ? -1 - node : node);
}

/// A node of a tool, where nodes of the tissue that lie on the tool say that the two touch.
bool SurfaceSurface::is_said_already(const Search& search, Index node, Index triangle,
                                     Real height) const {
  if (!search.nodes.boundary()->is_rigid()) return false;
  const Real place = place_of(search, node);
  const bool was_touched = !std::isnan(search.before.between(place - 0.5, place + 0.5));
  return held_.hold(search.faces.nodes(triangle), height, was_touched);
}

/// A node where a closed cut ends belongs to both walls, and the normals of these cancel out, so
/// that rounding says what it faces. It is within the tissue: the top of a flat element would throw
/// it out.
bool SurfaceSurface::ends_a_cut(const Search& search, const MovingSurface::SurfaceNode& n) {
  const auto sides = search.nodes.around(n);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Vec3& normal = search.node_normals.now(sides[i]);
    for (std::size_t j = 0; j < i; ++j)
      if (normal.dot(search.node_normals.now(sides[j])) < closed) return true;
  }
  return false;
}

/// A triangle whose normal has a larger cosine with `outward` faces neither the node nor one of its
/// sides: the cosine of the angle at which it would face the side that is turned furthest.
Real SurfaceSurface::turned_away(const Search& search, const MovingSurface::SurfaceNode& n,
                                 const Vec3& outward) {
  Real least = 1;
  for (const Index side : search.nodes.around(n))
    least = std::min(least, outward.dot(search.node_normals.now(side)));
  if (least <= facing) return 1;
  constexpr Real rounding = 1e-9;
  return facing * least + std::sqrt((1 - facing * facing) * std::max(1 - least * least, Real(0))) +
         rounding;
}

/// Of the rim of something thin the mean normal is that of its wide sides, and the rim goes first.
bool SurfaceSurface::faces_a_side(const Search& search, const MovingSurface::SurfaceNode& n,
                                  const Vec3& normal) {
  const auto sides = search.nodes.around(n);
  return std::any_of(sides.begin(), sides.end(), [&](Index side) {
    return normal.dot(search.node_normals.now(side)) <= facing;
  });
}

void SurfaceSurface::add_near(const Search& search, Index node, Index t, Seeker& seeker) {
  const MovingSurface& faces = search.faces;
  const Corners c = faces.now(t);
  const TrianglePoint foot = closest_point(seeker.at, c);
  const Vec3 apart = seeker.at - foot.on(c), normal = search.face_normals.now(t);
  const Real height = normal.dot(apart), slack = rounding * edge_length();
  // Further beside the triangle nothing touches, however near: whether it does must not change as
  // the gap closes.
  const Real aside = beside * search.around / depth;
  if ((apart - height * normal).norm() > aside) return;
  if (height > search.reach || height < -deepest(faces, t)) return;
  if (is_said_already(search, node, t, height)) return;
  if (height < -slack) {
    // What is behind a triangle is inside, or on the far side of something thin, or beside it. A
    // little before the node, so that what it belongs to does not count.
    if (!seeker.is_inside)
      seeker.is_inside = faces.boundary()->depth(seeker.at + slack * seeker.outward) > 0;
    if (!*seeker.is_inside) return;
  }
  near_.push_back({t, foot.weights, apart.norm()});
}

/// Where a node stands on the border of two triangles their normals differ: that of the lower
/// number is taken, whatever rounding says, else passes would go to and fro.
SurfaceSurface::Near SurfaceSurface::nearest() const {
  Real least = std::numeric_limits<Real>::infinity();
  for (const Near& on : near_) least = std::min(least, on.distance);
  Near best;
  for (const Near& on : near_)
    if (on.distance <= least + rounding * edge_length() &&
        (best.triangle < 0 || on.triangle < best.triangle))
      best = on;
  return best;
}

SurfaceSurface::Passing SurfaceSurface::passing(const MovingSurface& nodes, Index node,
                                                const MovingSurface& faces, Index t) const {
  const Real limit = -deepest(faces, t);
  const Vec3 to = nodes.point(node), from = to - nodes.moved(node);
  const auto height = [&](Real time) {
    const Corners c = faces.at(t, time);
    const Vec3 n = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    return n.dot(from + time * (to - from) - c[0]);
  };
  if (height(1) >= limit || height(0) < limit) return {};
  Real low = 0, high = 1;
  if (height(0) <= 0)
    high = 0;
  else
    for (int k = 0; k < 30; ++k) {
      const Real middle = (low + high) / 2;
      (height(middle) > 0 ? low : high) = middle;
    }
  const Corners c = faces.at(t, high);
  const Vec3 p = from + high * (to - from);
  const TrianglePoint foot = closest_point(p, c);
  if ((p - foot.on(c)).norm() > beside * edge_length()) return {};
  return {low, foot.weights};
}

/// Two nodes at one place meet each other twice. The one of the first surface stays, or of two of
/// one surface that with the smaller number.
void SurfaceSurface::drop_doubles(std::vector<Touch>& out) {
  const auto meets = [&](const Touch& t) {
    Index corner = -1;
    const Real weight = t.weights.maxCoeff(&corner);
    return weight == 1 ? faces_of(t).nodes(t.triangle)[static_cast<std::size_t>(corner)]
                       : Index{-1};
  };
  if (out.empty()) return;
  met_.assign(static_cast<std::size_t>(first_.surface_nodes().back().node) + 1, -1);
  for (const Touch& t : out)
    if (const Index other = meets(t); !t.nodes_are_second && other >= 0)
      met_[static_cast<std::size_t>(t.node)] = other;
  std::erase_if(out, [&](const Touch& t) {
    const Index other = meets(t);
    if (other < 0 || (is_self_ ? other > t.node : !t.nodes_are_second)) return false;
    return met_[static_cast<std::size_t>(other)] == t.node;
  });
}

Real SurfaceSurface::built_from(const Touch&) const {
  return margin * edge_length();
}

Vec3 SurfaceSurface::slip(const Touch& t) const {
  const Vec3 slip =
      nodes_of(t).moved(t.node_triangle, t.node_weights) - faces_of(t).moved(t.triangle, t.weights);
  return t.nodes_are_second ? Vec3(-slip) : slip;
}

void SurfaceSurface::couple(const Touch& t, BlockId block, const Directions& axes,
                            ConstraintBuilder& builder) const {
  const Directions on_nodes = t.nodes_are_second ? Directions(-axes) : axes;
  const auto couple_node = [&] {
    nodes_of(t).boundary()->couple(builder, block, on_nodes, t.node_triangle, t.node_weights, t.at);
  };
  const auto couple_face = [&] {
    faces_of(t).boundary()->couple(builder, block, -on_nodes, t.triangle, t.weights, t.at);
  };
  // The first coupling is that of the first body: its force is the one that is drawn.
  if (t.nodes_are_second)
    couple_face(), couple_node();
  else
    couple_node(), couple_face();
}

Pair::Tolerance SurfaceSurface::tolerance(const Touch& t) const {
  return {0.5, t.node < 0 ? 0.5 : std::numeric_limits<Real>::infinity()};
}

/// Touches hold nodes and edges that stand out apart. What they leave out, or a step that was not
/// solved has left, is an edge of one in a triangle of the other.
Real SurfaceSurface::unseen_overlap() {
  const Real least = seen * edge_length();
  const Real worst = through_first_.deepest(first_, second(), least);
  return is_self_ ? worst : std::max(worst, through_second_.deepest(second_, first_, least));
}

/// Of the nodes of one surface to the other.
Real SurfaceSurface::smallest_distance(const MovingSurface& nodes, const MovingSurface& faces) {
  Real smallest = std::numeric_limits<Real>::infinity();
  constexpr Real anywhere = 1e6;  // m
  for (const MovingSurface::SurfaceNode& n : nodes.surface_nodes()) {
    const Vec3 p = nodes.point(n.node);
    const Real inside = faces.boundary()->depth(p);
    smallest = std::min(
        smallest,
        inside > 0 ? -inside : faces.boundary()->distance(p, std::clamp(smallest, 0., anywhere)));
  }
  return smallest;
}

Real SurfaceSurface::distance() const {
  SurfaceSurface now(first_.boundary(), second().boundary());
  now.look(true);
  if (!is_self_) {
    const Real unseen = now.unseen_overlap();
    Real smallest = std::min(smallest_distance(now.first_, now.second_),
                             smallest_distance(now.second_, now.first_));
    if (unseen > 0) smallest = std::min(smallest, -unseen);
    std::vector<Touch> crossed;
    now.meet_edges(std::max(smallest, Real(0)), crossed);
    for (const Touch& t : crossed) smallest = std::min(smallest, t.gap);
    return smallest;
  }
  // Of one with itself only what faces each other counts, wider and wider until something does.
  std::vector<Touch> touches;
  const Real widest = now.first_.size();
  for (Real reach = margin * now.edge_length(); touches.empty() && reach < widest; reach *= 4)
    now.meet(false, reach, NoPlaces(), touches);
  Real smallest = std::numeric_limits<Real>::infinity();
  for (const Touch& t : touches) smallest = std::min(smallest, t.gap);
  return smallest;
}

}  // namespace sutura::contact
