// Touches of two surfaces where an edge of one crosses an edge of the other.
#include <algorithm>
#include <cmath>
#include <limits>

#include "surface_surface.h"

namespace sutura::contact {
namespace {

constexpr Real touching = 1e-3;  // of the depth that touches see: edges that are as near meet
constexpr Real parallel = 0.1;   // sine of the angle below which edges lie along each other

/// Two edges at a time of the step: their common normal, from the second to the first, and how far
/// they are apart along it.
struct CrossedEdges {
  Vec3 normal = Vec3::Zero();
  SegmentPair on;
  Real gap = 0;
  bool is_inner = false;  ///< both points are between the ends
};

CrossedEdges cross(const Segment& first, const Segment& second, const Vec3& up) {
  CrossedEdges out;
  const Vec3 u = (first.b - first.a).normalized(), v = (second.b - second.a).normalized();
  const Vec3 across = u.cross(v);
  const Real sine = across.norm();
  if (sine < parallel) return out;
  out.normal = (across.dot(up) < 0 ? -1 : 1) / sine * across;
  out.on = closest_points(first, second);
  out.is_inner = out.on.s > 0 && out.on.s < 1 && out.on.t > 0 && out.on.t < 1;
  out.gap = out.normal.dot(first.a - second.a);
  return out;
}

}  // namespace

void SurfaceSurface::meet_edges(Real reach, std::vector<Touch>& out) {
  if (!edges_first_.known()) {
    edges_first_.learn(first_);
    if (!is_self_) edges_second_.learn(second_);
  }
  edges_first_.look(first_, normals_first_);
  if (!is_self_) edges_second_.look(second_, normals_second_);
  const SurfaceEdges& others = edges_of_second();
  for (std::size_t i = 0; i < edges_first_.all().size(); ++i) {
    if (!edges_first_.is_ridge(static_cast<Index>(i))) continue;
    const SurfaceEdges::Edge& e = edges_first_.all()[i];
    Box box;
    for (const Real time : {0., 1.}) {
      const Segment s = SurfaceEdges::at(first_, e, time);
      box.add(s.a), box.add(s.b);
    }
    second().near(box.grown(std::max(reach, deepest(first_, e.triangle[0]))), [&](Index t) {
      others.of(t, [&](Index j) {
        const SurfaceEdges::Edge& f = others.all()[static_cast<std::size_t>(j)];
        if (!others.is_ridge(j) || (is_self_ && (j <= static_cast<Index>(i) || e.meets(f)))) return;
        meet_edges(static_cast<Index>(i), j, reach, out);
      });
    });
  }
}

void SurfaceSurface::meet_edges(Index i, Index j, Real reach, std::vector<Touch>& out) {
  const SurfaceEdges& others = edges_of_second();
  const SurfaceEdges::Edge& e = edges_first_.all()[static_cast<std::size_t>(i)];
  const SurfaceEdges::Edge& f = others.all()[static_cast<std::size_t>(j)];
  Real deep = std::numeric_limits<Real>::infinity();
  for (const Index t : e.triangle) deep = std::min(deep, deepest(first_, t));
  for (const Index t : f.triangle) deep = std::min(deep, deepest(second(), t));
  const auto at = [&](Real time, const Vec3& up) {
    return cross(SurfaceEdges::at(first_, e, time), SurfaceEdges::at(second(), f, time), up);
  };
  const auto faced = [&](const Vec3& normal, SurfaceEdges::When when) {
    return others.faces(j, normal, when) && edges_first_.faces(i, -normal, when);
  };
  const auto touch = [&](const CrossedEdges& where) {
    const Segment mine = SurfaceEdges::at(first_, e, 1), other = SurfaceEdges::at(second(), f, 1);
    Touch& t = out.emplace_back();
    constexpr Real edges = 1e9;  // numbers of edges begin after those of nodes
    t.first_place = edges + static_cast<Real>(i);
    t.second_place = static_cast<Real>(j);
    t.node_triangle = e.triangle[0];
    t.node_weights = e.weights(where.on.s);
    t.triangle = f.triangle[0];
    t.weights = f.weights(where.on.t);
    t.normal = where.normal;
    t.along = t.normal.unitOrthogonal();
    t.at = other.at(where.on.t);
    t.gap = t.normal.dot(mine.at(where.on.s) - t.at);
  };
  // Does its way lead through, deeper than a touch sees? Then it is touched where the two met: what
  // is carried does not go back.
  const CrossedEdges begin = at(0, others.outward(j, SurfaceEdges::start));
  if (begin.gap > -deep && !begin.normal.isZero() && faced(begin.normal, SurfaceEdges::start) &&
      at(1, begin.normal).gap < -deep) {
    Real low = 0, high = 1;
    for (int k = 0; k < 30; ++k) {
      const Real middle = (low + high) / 2;
      (at(middle, begin.normal).gap > std::min(begin.gap, Real(0)) ? low : high) = middle;
    }
    // Where they only turn past each other the gap changes its sign, too, and they are apart.
    const CrossedEdges met = at(high, begin.normal);
    const Real overlap = std::max(-begin.gap, Real(0)) + touching * deep;
    if (met.is_inner && met.on.squared_distance < overlap * overlap) {
      free_way_ = std::min(free_way_, low);
      return touch(met);
    }
  }
  const CrossedEdges now = at(1, others.outward(j, SurfaceEdges::now));
  if (now.is_inner && now.gap <= reach && now.gap >= -deep && faced(now.normal, SurfaceEdges::now)) touch(now);
}

}  // namespace sutura::contact
