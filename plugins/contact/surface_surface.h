// Touches of the surfaces of two solids, or of one with itself: nodes of each against triangles of
// the other that face them.
#pragma once

#include "moving_surface.h"
#include "touch.h"

namespace sutura::contact {

class SurfaceSurface : public Pair {
 public:
  SurfaceSurface(const MeshedSolid& first, const MeshedSolid& second)
      : first_(first), second_(second), is_self_(&first == &second) {}
  void find(const TouchedPlaces& before, std::vector<Touch>& out) override;
  Vec3 slip(const Touch& touch) const override;
  void couple(const Touch& touch, BlockId block, const Directions& axes,
              ConstraintBuilder& builder) const override;
  Real distance() const override;
  Tolerance tolerance(const Touch& touch) const override;

 private:
  const MovingSurface& second() const { return is_self_ ? first_ : second_; }
  static void add_normals(const MovingSurface& surface, std::vector<Vec3>& normals);
  /// Nodes of one surface against the other. `sign`: -1 where the nodes are those of the second.
  void meet(const MovingSurface& nodes, const std::vector<Vec3>& normals,
            const MovingSurface& faces, Real sign, std::vector<Touch>& out) const;
  void drop_doubles(std::vector<Touch>& out) const;
  Real edge_length() const;

  MovingSurface first_, second_;
  bool is_self_;
  Real reach_ = 1;                                    ///< times as far as touches are built from
  std::vector<Vec3> normals_first_, normals_second_;  ///< by node, not unit; zero inside
};

}  // namespace sutura::contact
