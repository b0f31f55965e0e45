#include "moving_surface.h"

#include <algorithm>
#include <cmath>

namespace sutura::contact {

void MovingSurface::look(bool standing) {
  now_ = solid_.surface(Configuration::current);
  start_ = standing ? now_ : solid_.surface(Configuration::start);
  if (!tree_) {
    const TriangleSurface rest = solid_.surface(Configuration::rest);
    std::vector<Vec3> centres;
    for (Index t = 0; t < rest.size(); ++t) {
      const Corners c = rest.corners(t);
      centres.push_back((c[0] + c[1] + c[2]) / 3);
    }
    tree_ = std::make_unique<BoxTree>(centres);
  }
  tree_->refit(boxes_, [this](Index t) { return of(t); });
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
