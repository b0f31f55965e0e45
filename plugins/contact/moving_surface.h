// A boundary on its way through a step, with boxes around the way of each triangle.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "boundary.h"
#include "sutura/geometry/box_tree.h"
#include "sutura/geometry/distances.h"
#include "sutura/geometry/triangle_surface.h"

namespace sutura::contact {

/// Mean length of the edges of its triangles, 0 of none (m).
Real mean_edge(const TriangleSurface& surface);

class MovingSurface {
 public:
  explicit MovingSurface(std::shared_ptr<const Boundary> boundary)
      : boundary_(std::move(boundary)) {}
  /// `standing`: as it is now, without its way. False if all is where it was at the last look.
  bool look(bool standing = false);

  const std::shared_ptr<const Boundary>& boundary() const { return boundary_; }
  Index triangles() const { return now_.size(); }
  const std::array<Index, 3>& nodes(Index triangle) const {
    return now_.triangles[static_cast<std::size_t>(triangle)];
  }
  Corners now(Index triangle) const { return now_.corners(triangle); }
  Corners at_start(Index triangle) const { return start_.corners(triangle); }
  Vec3 point(Index node) const { return now_.point(node); }
  Vec3 moved(Index node) const { return now_.point(node) - start_.point(node); }
  Corners at(Index triangle, Real time) const;
  /// No corner moves further, less a `common` motion (m).
  Real motion(Index triangle, const Vec3& common) const;
  /// Displacement over the step of a point of a triangle.
  Vec3 moved(Index triangle, const Vec3& weights) const;
  /// May p be inside? If not, it is not.
  bool bounds(const Vec3& p) const { return around_all().squared_distance(p) == 0; }
  /// Diagonal of the box around its way, along the axes (m).
  Real size() const { return triangles() > 0 ? (around_all().high - around_all().low).norm() : 0; }
  /// Nodes of the surface by ascending number, each as a corner of one of its triangles.
  struct SurfaceNode {
    Index node = -1, triangle = -1;
    Vec3 weights = Vec3::Zero();
    Index first = 0, last = 0;  ///< its triangles, in `around`
  };
  /// The triangles that a node is a corner of.
  std::span<const Index> around(const SurfaceNode& n) const {
    return {around_.data() + n.first, static_cast<std::size_t>(n.last - n.first)};
  }
  /// The angles that these have there, at rest (rad).
  std::span<const Real> angles(const SurfaceNode& n) const {
    return {angles_.data() + n.first, static_cast<std::size_t>(n.last - n.first)};
  }
  const std::vector<SurfaceNode>& surface_nodes() const { return nodes_; }
  /// Mean length of the edges of the triangles, at rest (m).
  Real edge_length() const { return edge_length_; }
  /// From the middle of a triangle straight through to the other side, at rest (m).
  Real thickness(Index triangle) const { return thickness_[static_cast<std::size_t>(triangle)]; }
  /// Calls `item(triangle)` for those whose way may meet the box.
  template <class Item>
  void near(const Box& box, const Item& item) const {
    if (triangles() == 0) return;
    fit();
    tree_->visit(
        boxes_, [&](const Box& b) { return b.meets(box); },
        [&](Index t) {
          if (ways_[static_cast<std::size_t>(t)].meets(box)) item(t);
        });
  }

 private:
  Box way(Index triangle) const;
  /// The boxes, if somebody asks for them.
  void fit() const;
  Box around_all() const {
    fit();
    return boxes_.empty() ? Box{} : boxes_[0];
  }
  void learn();
  static Real angle_at(const TriangleSurface& rest, const SurfaceNode& corner);
  void learn_thickness(const TriangleSurface& rest);

  std::shared_ptr<const Boundary> boundary_;
  TriangleSurface start_, now_;
  bool stands_ = false;
  std::unique_ptr<BoxTree> tree_;  ///< made once, from the surface at rest
  mutable bool fitted_ = false;
  mutable BoxTree::Boxes boxes_;
  mutable std::vector<Box> ways_;  ///< by triangle: around its way
  std::vector<SurfaceNode> nodes_;
  Real edge_length_ = 0;
  std::vector<Real> thickness_;  ///< by triangle
  std::vector<Index> around_;    ///< triangles of the nodes, one node after the other
  std::vector<Real> angles_;     ///< of each of these at its node (rad)
};

}  // namespace sutura::contact
