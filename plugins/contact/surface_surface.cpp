#include "surface_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace sutura::contact {
namespace {

// In units of the mean edge of the triangles.
constexpr Real depth = 0.5;      // a node that has come through is found so far behind a triangle
constexpr Real margin = 0.25;    // a touch is built from this far, before there is one
constexpr Real beside = 0.1;     // a node may stand so far beside a triangle
constexpr Real seen = 0.1;       // deeper than this no overlap is left without a fault
constexpr Real rounding = 1e-3;  // as far behind a triangle a node counts as being on it
// Nor deeper than this part of the way through: there the other side is nearer.
constexpr Real half_way = 0.5;
// Cosine between the normal of a triangle and that of a node that faces it, at most.
constexpr Real facing = -0.2;

/// Is any node of a triangle?
bool is_touched(const std::vector<char>& touched, const std::array<Index, 3>& nodes) {
  return std::any_of(nodes.begin(), nodes.end(),
                     [&](Index node) { return touched[static_cast<std::size_t>(node)] != 0; });
}

}  // namespace

void SurfaceSurface::add_normals(const MovingSurface& surface, std::vector<Vec3>& normals) {
  for (Vec3& n : normals) n.setZero();
  for (Index t = 0; t < surface.triangles(); ++t) {
    const Corners c = surface.now(t);
    const Vec3 normal = (c[1] - c[0]).cross(c[2] - c[0]);
    for (const Index node : surface.nodes(t)) {
      if (static_cast<std::size_t>(node) >= normals.size())
        normals.resize(static_cast<std::size_t>(node) + 1, Vec3::Zero());
      normals[static_cast<std::size_t>(node)] += normal;
    }
  }
}

Real SurfaceSurface::edge_length() const {
  if (second().boundary()->is_rigid()) return first_.edge_length();
  return std::min(first_.edge_length(), second().edge_length());
}

Real SurfaceSurface::deepest(const MovingSurface& faces, Index triangle) const {
  return std::min(depth * edge_length(), half_way * faces.thickness(triangle));
}

void SurfaceSurface::find(const TouchedPlaces&, std::vector<Touch>& out) {
  free_way_ = 1;
  first_.look();
  add_normals(first_, normals_first_);
  if (!is_self_) {
    second_.look();
    add_normals(second_, normals_second_);
  }
  const Real reach = margin * edge_length();
  meet(false, reach, out);
  if (second().boundary()->is_rigid()) {
    // What lies on a tool is held at its nodes: where the tool's nodes are in the same triangles,
    // they would say it again.
    touched_first_.assign(normals_first_.size(), 0);
    for (const Touch& t : out) touched_first_[static_cast<std::size_t>(t.node)] = 1;
  }
  if (!is_self_) meet(true, reach, out);
  drop_doubles(out);
  meet_edges(reach, out);
}

void SurfaceSurface::meet(bool nodes_are_second, Real reach, std::vector<Touch>& out) {
  const MovingSurface& nodes = nodes_are_second ? second() : first_;
  const MovingSurface& faces = nodes_are_second ? first_ : second();
  const std::vector<Vec3>& normals = nodes_are_second ? normals_second_ : normals_first_;
  const Real edge = edge_length();
  const bool node_is_rigid = nodes.boundary()->is_rigid();
  const Real around = std::max(reach, depth * edge), aside = beside * around / depth;
  for (const MovingSurface::SurfaceNode& n : nodes.surface_nodes()) {
    const Index node = n.node;
    const Vec3 p = nodes.point(node);
    const Vec3 outward = normals[static_cast<std::size_t>(node)].normalized();
    Box box;
    box.add(p), box.add(p - nodes.moved(node));
    // Of the rim of something thin the mean is that of its wide sides, and the rim goes first.
    const auto faces_a_side = [&](const Vec3& normal) {
      const auto sides = nodes.around(n);
      return std::any_of(sides.begin(), sides.end(),
                         [&](Index side) { return normal.dot(nodes.normal(side)) <= facing; });
    };
    // What is behind a triangle is inside, or on the far side of something thin, or beside it. A
    // little before the node, so that what it belongs to does not count.
    std::optional<bool> inside;
    const auto is_inside = [&] {
      if (!inside) inside = faces.boundary()->depth(p + rounding * edge * outward) > 0;
      return *inside;
    };
    near_.clear();
    Touch best;
    Real least = std::numeric_limits<Real>::infinity(), free = 1;
    const auto take = [&](Index t, const Vec3& weights, const Vec3& normal) {
      const Corners c = faces.now(t);
      best.triangle = t;
      best.weights = weights;
      best.normal = nodes_are_second ? Vec3(-normal) : normal;
      best.at = weights[0] * c[0] + weights[1] * c[1] + weights[2] * c[2];
      best.gap = normal.dot(p - best.at);
    };
    faces.near(box.grown(around), [&](Index t) {
      const auto& corners = faces.nodes(t);
      const bool own =
          &nodes == &faces && (corners[0] == node || corners[1] == node || corners[2] == node);
      const bool is_said = node_is_rigid && is_touched(touched_first_, corners);
      const Vec3 normal = faces.normal(t);
      if (own || is_said) return;
      const bool is_facing = normal.dot(outward) <= facing;
      const Passing way = passing(nodes, node, faces, t);
      if (way.free < free && (is_facing || faces_a_side(normal))) {
        free = way.free;
        take(t, way.weights, normal);
      }
      if (free < 1 || !is_facing) return;
      const Corners c = faces.now(t);
      const TrianglePoint foot = closest_point(p, c);
      const Vec3 apart = p - foot.on(c);
      const Real height = normal.dot(apart), distance = apart.norm();
      // Further beside the triangle nothing touches, however near: whether it does must not change
      // as the gap closes.
      if ((apart - height * normal).norm() > aside) return;
      if (height > reach || height < -deepest(faces, t)) return;
      if (height < -rounding * edge && !is_inside()) return;
      least = std::min(least, distance);
      near_.push_back({t, foot.weights, distance});
    });
    // Where it stands on the border of two triangles their normals differ: that of the lower number
    // is taken, whatever rounding says, else passes would go to and fro.
    for (const Near& on : near_)
      if (free == 1 && on.distance <= least + rounding * edge &&
          (best.triangle < 0 || on.triangle < best.triangle))
        take(on.triangle, on.weights, faces.normal(on.triangle));
    free_way_ = std::min(free_way_, free);
    if (best.triangle < 0) continue;
    best.node = node;
    best.node_triangle = n.triangle;
    best.node_weights = n.weights;
    best.nodes_are_second = nodes_are_second;
    best.first_place = static_cast<Real>(nodes_are_second ? -1 - node : node);
    best.along = best.normal.unitOrthogonal();
    out.push_back(best);
  }
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
  met_.assign(normals_first_.size(), -1);
  for (const Touch& t : out)
    if (!t.nodes_are_second) met_[static_cast<std::size_t>(t.node)] = meets(t);
  std::erase_if(out, [&](const Touch& t) {
    const Index other = meets(t);
    if (other < 0 || (is_self_ ? other > t.node : !t.nodes_are_second)) return false;
    return met_[static_cast<std::size_t>(other)] == t.node;
  });
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

/// An edge that crosses a triangle must be moved by the smallest of these to be clear of it: by how
/// far its ends are before and behind, and by how far the place is from the border.
Real SurfaceSurface::edges_through(const MovingSurface& edges, const MovingSurface& faces) const {
  Real worst = 0;
  for (Index t = 0; t < edges.triangles(); ++t) {
    const auto& nodes = edges.nodes(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const Index from = nodes[k], to = nodes[(k + 1) % 3];
      if (from > to) continue;  // the triangle beside has it too
      const Segment edge{edges.point(from), edges.point(to)};
      Box box;
      box.add(edge.a), box.add(edge.b);
      faces.near(box, [&](Index other) {
        const auto& corners = faces.nodes(other);
        if (is_self_ && std::any_of(corners.begin(), corners.end(),
                                    [&](Index node) { return node == from || node == to; }))
          return;
        const Corners c = faces.now(other);
        const Vec3 normal = faces.normal(other);
        const Real before = normal.dot(edge.a - c[0]), behind = normal.dot(edge.b - c[0]);
        if (before * behind >= 0) return;
        const Vec3 place = edge.at(before / (before - behind));
        Real through = std::min(std::abs(before), std::abs(behind));
        for (std::size_t i = 0; i < 3; ++i) {
          const Vec3 side = c[(i + 1) % 3] - c[i];
          through = std::min(through, normal.dot(side.cross(place - c[i])) / side.norm());
        }
        worst = std::max(worst, through);
      });
    }
  }
  return worst;
}

/// Touches hold nodes and edges that stand out apart. What they leave out, or a step that was not
/// solved has left, is an edge of one in a triangle of the other.
Real SurfaceSurface::unseen_overlap() const {
  Real worst = edges_through(first_, second());
  if (!is_self_) worst = std::max(worst, edges_through(second_, first_));
  return worst > seen * edge_length() ? worst : 0;
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
  now.first_.look(true);
  if (!is_self_) {
    now.second_.look(true);
    add_normals(now.first_, now.normals_first_);
    add_normals(now.second_, now.normals_second_);
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
  add_normals(now.first_, now.normals_first_);
  std::vector<Touch> touches;
  const Real widest = now.first_.size();
  for (Real reach = margin * now.edge_length(); touches.empty() && reach < widest; reach *= 4)
    now.meet(false, reach, touches);
  Real smallest = std::numeric_limits<Real>::infinity();
  for (const Touch& t : touches) smallest = std::min(smallest, t.gap);
  return smallest;
}

}  // namespace sutura::contact
