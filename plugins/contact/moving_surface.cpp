#include "moving_surface.h"

#include <algorithm>
#include <cmath>

namespace sutura::contact {

void MovingSurface::look(bool standing) {
  now_ = boundary_->surface(Configuration::current);
  start_ = standing ? now_ : boundary_->surface(Configuration::start);
  if (!tree_) learn();
  tree_->refit(boxes_, [this](Index t) { return of(t); });
}

/// What stays as it is at rest: so a run that was interrupted finds the same.
void MovingSurface::learn() {
  const TriangleSurface rest = boundary_->surface(Configuration::rest);
  std::vector<Vec3> centres;
  Real sum = 0;
  for (Index t = 0; t < rest.size(); ++t) {
    const Corners c = rest.corners(t);
    centres.push_back((c[0] + c[1] + c[2]) / 3);
    for (std::size_t k = 0; k < 3; ++k) {
      sum += (c[(k + 1) % 3] - c[k]).norm();
      nodes_.push_back({nodes(t)[k], t, Vec3::Unit(static_cast<Index>(k))});
    }
  }
  tree_ = std::make_unique<BoxTree>(centres);
  edge_length_ = sum / static_cast<Real>(std::max<Index>(3 * rest.size(), 1));
  std::stable_sort(nodes_.begin(), nodes_.end(),
                   [](const SurfaceNode& a, const SurfaceNode& b) { return a.node < b.node; });
  const auto same = [](const SurfaceNode& a, const SurfaceNode& b) { return a.node == b.node; };
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end(), same), nodes_.end());
}

Box MovingSurface::of(Index t) const {
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
