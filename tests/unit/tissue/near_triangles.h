// Which triangles of a solid come near a segment: an example of docs/extend/geometry.md.
#pragma once

#include <vector>

#include "sutura/geometry/box_tree.h"
#include "sutura/geometry/distances.h"
#include "sutura/geometry/triangle_surface.h"

namespace sutura::test {

class NearTriangles {
 public:
  explicit NearTriangles(const MeshedSolid& solid)
      : solid_(solid), tree_(middles(solid.surface(Configuration::rest))) {}

  /// Calls found(triangle, pair) for all that come within `reach` (m).
  template <class Found>
  void visit(const Segment& segment, Real reach, Found found) {
    const TriangleSurface surface = solid_.surface(Configuration::current);
    if (surface.generation != fitted_)
      tree_.refit(boxes_, [&](Index i) { return box(surface, i); });
    fitted_ = surface.generation;
    Box near;
    near.add(segment.a);
    near.add(segment.b);
    near = near.grown(reach);
    tree_.visit(
        boxes_, [&](const Box& box) { return box.meets(near); },
        [&](Index triangle) {
          const SegmentTriangle pair = closest_points(segment, surface.corners(triangle));
          if (pair.squared_distance <= reach * reach) found(triangle, pair);
        });
  }

 private:
  static std::vector<Vec3> middles(const TriangleSurface& surface) {
    std::vector<Vec3> out;
    for (Index i = 0; i < surface.size(); ++i) {
      const Corners t = surface.corners(i);
      out.push_back((t[0] + t[1] + t[2]) / 3);
    }
    return out;
  }
  static Box box(const TriangleSurface& surface, Index triangle) {
    Box b;
    for (const Vec3& p : surface.corners(triangle)) b.add(p);
    return b;
  }

  const MeshedSolid& solid_;
  BoxTree tree_;
  BoxTree::Boxes boxes_;
  std::uint64_t fitted_ = 0;
};

}  // namespace sutura::test
