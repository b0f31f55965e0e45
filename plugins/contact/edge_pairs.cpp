// Touches of two surfaces where an edge of one crosses an edge of the other.
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "surface_surface.h"

namespace sutura::contact {
namespace {

constexpr Real touching = 1e-3;  // of the depth that touches see: edges that are as near meet
constexpr Real parallel = 0.1;   // sine of the angle below which edges lie along each other

/// Two edges at a time of the step: their common normal, from the second to the first, and how far
/// they are apart along it. No normal if they lie along each other.
struct CrossedEdges {
  Segment first, second;
  Vec3 normal = Vec3::Zero();
  Real gap = 0;
  SegmentPair nearest() const { return closest_points(first, second); }
};

CrossedEdges cross(const Segment& first, const Segment& second, const Vec3& up) {
  CrossedEdges out{first, second};
  const Vec3 u = (first.b - first.a).normalized(), v = (second.b - second.a).normalized();
  const Vec3 across = u.cross(v);
  const Real sine = across.norm();
  if (sine < parallel) return out;
  out.normal = (across.dot(up) < 0 ? -1 : 1) / sine * across;
  out.gap = out.normal.dot(first.a - second.a);
  return out;
}

/// Are both points between the ends of their edges?
bool is_inner(const SegmentPair& on) {
  return on.s > 0 && on.s < 1 && on.t > 0 && on.t < 1;
}

}  // namespace

void SurfaceSurface::meet_edges(Real reach, std::vector<Touch>& out) {
  if (!edges_first_.known()) {
    edges_first_.learn(first_);
    if (!is_self_) edges_second_.learn(second_);
  }
  edges_first_.look(first_, normals_first_);
  if (!is_self_) edges_second_.look(second_, normals_second_);
  ridges_.clear();
  add_ridges(false, reach);
  if (!is_self_) add_ridges(true, reach);
  find_near_ridges();
  for (const auto& [i, j] : near_ridges_) meet_edges(i, j, reach, out);
}

void SurfaceSurface::add_ridges(bool of_second, Real reach) {
  const MovingSurface& surface = of_second ? second_ : first_;
  const SurfaceEdges& edges = of_second ? edges_second_ : edges_first_;
  for (Index i = 0; i < edges.size(); ++i) {
    if (!edges.is_ridge(i)) continue;
    const SurfaceEdges::Edge& e = edges[i];
    Box way;
    for (const Real time : {0., 1.}) {
      const Segment s = SurfaceEdges::at(surface, e, time);
      way.add(s.a), way.add(s.b);
    }
    const Real around = of_second ? 0 : std::max(reach, deepest(first_, e.triangle[0]));
    ridges_.push_back({i, of_second, way.grown(around)});
  }
}

/// Sorted along the longest axis: whatever begins before another one ends may meet it.
void SurfaceSurface::find_near_ridges() {
  near_ridges_.clear();
  Box all;
  for (const Ridge& r : ridges_) all.add(r.way);
  Index axis = 0;
  (all.high - all.low).maxCoeff(&axis);
  std::sort(ridges_.begin(), ridges_.end(), [axis](const Ridge& a, const Ridge& b) {
    return std::tie(a.way.low[axis], a.is_second, a.edge) <
           std::tie(b.way.low[axis], b.is_second, b.edge);
  });
  for (std::size_t k = 0; k < ridges_.size(); ++k) {
    const Ridge& a = ridges_[k];
    for (std::size_t l = k + 1; l < ridges_.size(); ++l) {
      const Ridge& b = ridges_[l];
      if (b.way.low[axis] > a.way.high[axis]) break;
      if (!a.way.meets(b.way) || (!is_self_ && a.is_second == b.is_second)) continue;
      if (is_self_ && edges_first_[a.edge].meets(edges_first_[b.edge])) continue;
      const bool in_order = is_self_ ? a.edge < b.edge : b.is_second;
      near_ridges_.push_back(in_order ? std::pair(a.edge, b.edge) : std::pair(b.edge, a.edge));
    }
  }
  std::sort(near_ridges_.begin(), near_ridges_.end());
}

void SurfaceSurface::meet_edges(Index i, Index j, Real reach, std::vector<Touch>& out) {
  const SurfaceEdges& others = edges_of_second();
  const SurfaceEdges::Edge &e = edges_first_[i], &f = others[j];
  Real deep = std::numeric_limits<Real>::infinity();
  for (const Index t : e.triangle) deep = std::min(deep, deepest(first_, t));
  for (const Index t : f.triangle) deep = std::min(deep, deepest(second(), t));
  const auto at = [&](Real time, const Vec3& up) {
    return cross(SurfaceEdges::at(first_, e, time), SurfaceEdges::at(second(), f, time), up);
  };
  const auto faced = [&](const Vec3& normal, SurfaceEdges::When when) {
    return others.faces(j, normal, when) && edges_first_.faces(i, -normal, when);
  };
  const auto touch = [&](const Vec3& normal, const SegmentPair& on) {
    const Segment mine = SurfaceEdges::at(first_, e, 1), other = SurfaceEdges::at(second(), f, 1);
    Touch& t = out.emplace_back();
    constexpr Real edges = 1e9;  // numbers of edges begin after those of nodes
    t.first_place = edges + static_cast<Real>(i);
    t.second_place = static_cast<Real>(j);
    t.node_triangle = e.triangle[0];
    t.node_weights = e.weights(on.s);
    t.triangle = f.triangle[0];
    t.weights = f.weights(on.t);
    t.normal = normal;
    t.along = t.normal.unitOrthogonal();
    t.at = other.at(on.t);
    t.gap = t.normal.dot(mine.at(on.s) - t.at);
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
    const SegmentPair on = met.nearest();
    const Real overlap = std::max(-begin.gap, Real(0)) + touching * deep;
    if (is_inner(on) && on.squared_distance < overlap * overlap) {
      free_way_ = std::min(free_way_, low);
      return touch(met.normal, on);
    }
  }
  const CrossedEdges now = at(1, others.outward(j, SurfaceEdges::now));
  if (!(now.gap <= reach && now.gap >= -deep) || !faced(now.normal, SurfaceEdges::now)) return;
  if (const SegmentPair on = now.nearest(); is_inner(on)) touch(now.normal, on);
}

}  // namespace sutura::contact
