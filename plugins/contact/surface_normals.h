// Normals of a surface on its way through a step.
#pragma once

#include <vector>

#include "moving_surface.h"

namespace sutura::contact {

class SurfaceNormals {
 public:
  void look(const MovingSurface& surface);
  /// Of a triangle, outward and unit: at the guess, and as the step begins.
  const Vec3& now(Index triangle) const { return now_[static_cast<std::size_t>(triangle)]; }
  const Vec3& at_start(Index triangle) const { return start_[static_cast<std::size_t>(triangle)]; }
  /// Of a node of that surface at the guess: the mean of its triangles by their angles there, as
  /// they are at rest. By their areas the tip of something slender would look aside.
  Vec3 of_node(const MovingSurface& surface, const MovingSurface::SurfaceNode& node) const;

 private:
  std::vector<Vec3> now_, start_;  ///< by triangle
};

}  // namespace sutura::contact
