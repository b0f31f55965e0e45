// Where is this point: in which tet, how far from the boundary, on which side; where does a segment
// leave or enter. For one set of positions; the tissue keeps one of these per configuration.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "mesh_check.h"
#include "mesh_data.h"
#include "sutura/geometry/box_tree.h"
#include "sutura/geometry/triangle_surface.h"

namespace sutura::tissue {

/// What does not depend on the positions: trees and adjacency, made on the rest shape.
class SolidTopology {
 public:
  SolidTopology(const std::vector<Vec3>& rest, std::vector<Tet> tets,
                const std::vector<BoundaryFace>& boundary);

  /// A point of a triangle of the boundary as a point of the tet behind it.
  EmbeddedPoint on_surface(Index triangle, const Vec3& weights) const;

 private:
  friend class SolidQueries;
  std::vector<Tet> tets_;
  std::vector<Triangle> triangles_;            ///< of the boundary
  std::vector<Index> tet_behind_;              ///< per triangle
  std::vector<std::array<Index, 3>> edge_of_;  ///< per triangle: edges 01, 12, 20
  Index edges_ = 0;
  BoxTree tet_tree_, triangle_tree_;
};

/// Answers depend on the positions only, never on the order of search: among equals the lowest
/// number wins. Boxes and normals are refitted at the first question after `move`. Not for several
/// workers at once.
class SolidQueries {
 public:
  explicit SolidQueries(std::shared_ptr<const SolidTopology> topology)
      : topology_(std::move(topology)) {}

  /// `x`: 3 n numbers, kept by reference.
  void move(const VecX& x) {
    x_ = &x;
    ++generation_;
    tets_fitted_ = triangles_fitted_ = normals_found_ = false;
  }

  /// Refits at once: what comes after it allocates nothing.
  void fit() const {
    fit_tets();
    fit_triangles();
    find_normals();
  }

  const SolidTopology& topology() const { return *topology_; }
  TriangleSurface surface() const {
    return {topology_->triangles_, {x_->data(), static_cast<std::size_t>(x_->size())}, generation_};
  }

  std::optional<EmbeddedPoint> locate(const Vec3& p) const;
  /// The sign comes from the angle-weighted normal of the nearest vertex, edge or face, which is
  /// right everywhere (Baerentzen and Aanaes, 2005); that normal is the one returned.
  std::optional<SurfacePoint> closest_surface(const Vec3& p, Real reach,
                                              const Vec3& facing = Vec3::Zero()) const;
  /// No gap between triangles: a segment through an edge or vertex hits one of its triangles.
  std::optional<SurfacePoint> crossing(const Vec3& a, const Vec3& b,
                                       const Vec3& facing = Vec3::Zero()) const;
  Vec3 surface_normal(Index triangle) const;
  /// The node of the boundary that is deepest in elements that it is no corner of, behind the
  /// nearest triangle that faces it: a point of that triangle, whose distance is negative. It is in
  /// them if what is by `slack` before it is. Not seen: an edge across another, and a node where a
  /// closed cut ends, which has no side.
  std::optional<SurfacePoint> deepest_in_itself(Real slack) const;
  Vec3 position(const EmbeddedPoint& p) const;

 private:
  bool faces(Index triangle, const Vec3& direction) const;
  bool is_in_others(Index corner, const Vec3& p) const;
  Vec3 point(Index node) const { return x_->segment<3>(3 * node); }
  std::array<Vec3, 3> corners(Index triangle) const;
  SurfacePoint on_triangle(Index triangle, const Vec3& weights) const;
  void fit_tets() const;
  void fit_triangles() const;
  /// Of corners and edges.
  void find_normals() const;

  std::shared_ptr<const SolidTopology> topology_;
  const VecX* x_ = nullptr;
  std::uint64_t generation_ = 0;  ///< of the positions
  mutable bool tets_fitted_ = false, triangles_fitted_ = false, normals_found_ = false;
  mutable BoxTree::Boxes tet_boxes_, triangle_boxes_;
  mutable std::vector<Vec3> vertex_normal_, edge_normal_;  ///< not normalised; vertices by node
};

}  // namespace sutura::tissue
