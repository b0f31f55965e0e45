#include "moving_surface.h"

#include <algorithm>
#include <cmath>

namespace sutura::contact {

Real mean_edge(const TriangleSurface& surface) {
  Real sum = 0;
  for (Index t = 0; t < surface.size(); ++t) {
    const Corners c = surface.corners(t);
    for (std::size_t k = 0; k < 3; ++k) sum += (c[(k + 1) % 3] - c[k]).norm();
  }
  return sum / static_cast<Real>(std::max<Index>(3 * surface.size(), 1));
}

bool MovingSurface::look(bool standing) {
  const std::uint64_t seen_now = now_.generation, seen_start = start_.generation;
  now_ = boundary_->surface(Configuration::current);
  start_ = standing ? now_ : boundary_->surface(Configuration::start);
  if (!tree_)
    learn();
  else if (now_.generation == seen_now && start_.generation == seen_start && stands_ == standing)
    return false;
  stands_ = standing;
  fitted_ = false;
  return true;
}

void MovingSurface::fit() const {
  if (fitted_ || !tree_) return;
  fitted_ = true;
  ways_.resize(static_cast<std::size_t>(triangles()));
  tree_->refit(boxes_, [this](Index t) { return ways_[static_cast<std::size_t>(t)] = way(t); });
}

Real MovingSurface::angle_at(const TriangleSurface& rest, const SurfaceNode& corner) {
  Index k = 0;
  corner.weights.maxCoeff(&k);
  const Corners c = rest.corners(corner.triangle);
  const auto side = [&](Index to) {
    return Vec3(c[static_cast<std::size_t>((k + to) % 3)] - c[static_cast<std::size_t>(k)]);
  };
  return std::atan2(side(1).cross(side(2)).norm(), side(1).dot(side(2)));
}

/// What stays as it is at rest: so a run that was interrupted finds the same.
void MovingSurface::learn() {
  const TriangleSurface rest = boundary_->surface(Configuration::rest);
  std::vector<Vec3> centres;
  for (Index t = 0; t < rest.size(); ++t) {
    const Corners c = rest.corners(t);
    centres.push_back((c[0] + c[1] + c[2]) / 3);
    for (std::size_t k = 0; k < 3; ++k)
      nodes_.push_back({nodes(t)[k], t, Vec3::Unit(static_cast<Index>(k))});
  }
  tree_ = std::make_unique<BoxTree>(centres);
  edge_length_ = mean_edge(rest);
  std::stable_sort(nodes_.begin(), nodes_.end(),
                   [](const SurfaceNode& a, const SurfaceNode& b) { return a.node < b.node; });
  std::size_t count = 0;
  for (const SurfaceNode& n : nodes_) {
    if (count == 0 || nodes_[count - 1].node != n.node) {
      nodes_[count] = n;
      nodes_[count++].first = static_cast<Index>(around_.size());
    }
    around_.push_back(n.triangle);
    angles_.push_back(angle_at(rest, n));
    nodes_[count - 1].last = static_cast<Index>(around_.size());
  }
  nodes_.resize(count);
  learn_thickness(rest);
}

void MovingSurface::learn_thickness(const TriangleSurface& rest) {
  Box all;
  tree_->refit(boxes_, [&](Index t) {
    Box box;
    for (const Vec3& p : rest.corners(t)) box.add(p), all.add(p);
    return box;
  });
  const Real through = (all.high - all.low).norm();
  const Real nowhere = 1e-3 * edge_length_;  // the other wall of a cut that is closed, not of t
  for (Index t = 0; t < rest.size(); ++t) {
    const Corners c = rest.corners(t);
    const Vec3 middle = (c[0] + c[1] + c[2]) / 3, inwards = -rest.area_normal(t).normalized();
    const Segment ray{middle, middle + through * inwards};
    Real nearest = through;
    tree_->visit(
        boxes_, [&](const Box& box) { return box.meets_segment(ray.a, ray.b, 0); },
        [&](Index other) {
          // The other side: what looks the way that the ray goes.
          if (other == t || rest.area_normal(other).dot(inwards) <= 0) return;
          const SegmentTriangle met = closest_points(ray, rest.corners(other));
          if (met.squared_distance != 0 || met.s * through <= nowhere) return;
          nearest = std::min(nearest, met.s * through);
        });
    thickness_.push_back(nearest);
  }
}

Box MovingSurface::way(Index t) const {
  Box box;
  for (const Vec3& p : start_.corners(t)) box.add(p);
  for (const Vec3& p : now_.corners(t)) box.add(p);
  return box;
}

Corners MovingSurface::at(Index t, Real time) const {
  const Corners from = start_.corners(t), to = now_.corners(t);
  Corners out;
  for (std::size_t k = 0; k < 3; ++k) out[k] = from[k] + time * (to[k] - from[k]);
  return out;
}

Real MovingSurface::motion(Index t, const Vec3& common) const {
  Real most = 0;
  for (const Index node : nodes(t)) most = std::max(most, (moved(node) - common).squaredNorm());
  return std::sqrt(most);
}

Vec3 MovingSurface::moved(Index t, const Vec3& weights) const {
  const auto& n = nodes(t);
  return weights[0] * moved(n[0]) + weights[1] * moved(n[1]) + weights[2] * moved(n[2]);
}

}  // namespace sutura::contact
