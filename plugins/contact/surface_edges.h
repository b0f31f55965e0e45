// The ridges of a surface: edges that stand out, where another edge can touch it though no node of
// one is at a triangle of the other.
#pragma once

#include <array>
#include <vector>

#include "surface_normals.h"

namespace sutura::contact {

class SurfaceEdges {
 public:
  struct Edge {
    std::array<Index, 2> node{};
    std::array<Index, 2> triangle{};
    std::array<Index, 2> corner{};  ///< of the first triangle: where the two nodes are
    Index opposite = -1;            ///< the node of the second triangle that is not on the edge
    /// Of the point at u in [0, 1], in the first triangle.
    Vec3 weights(Real u) const {
      return (1 - u) * Vec3::Unit(corner[0]) + u * Vec3::Unit(corner[1]);
    }
    bool meets(const Edge& other) const {
      return node[0] == other.node[0] || node[0] == other.node[1] || node[1] == other.node[0] ||
             node[1] == other.node[1];
    }
  };
  /// All edges between two triangles, once.
  void learn(const MovingSurface& surface);
  bool known() const { return known_; }
  Index size() const { return static_cast<Index>(edges_.size()); }
  const Edge& operator[](Index edge) const { return edges_[static_cast<std::size_t>(edge)]; }

  /// Where it is at a time of the step.
  static Segment at(const MovingSurface& surface, const Edge& edge, Real time);

  /// Which of them stand out now, and which as the step begins.
  void look(const MovingSurface& surface, const SurfaceNormals& normals);
  /// Does it stand out at one of the two?
  bool is_ridge(Index edge) const {
    const auto& n = sides_[static_cast<std::size_t>(edge)];
    return n[0].is_ridge || n[1].is_ridge;
  }
  enum When { start, now };
  /// Does it stand out, and can what comes from `direction` (unit) touch it before its sides?
  bool faces(Index edge, const Vec3& direction, When when) const;
  /// Mean outward direction of its sides, not unit; zero of an edge that does not stand out.
  Vec3 outward(Index edge, When when) const;

 private:
  struct Sides {
    Vec3 first, second;  ///< normals, unit
    bool is_ridge = false;
  };
  bool known_ = false;
  std::vector<Edge> edges_;
  std::vector<std::array<Sides, 2>> sides_;  ///< by edge and When
};

}  // namespace sutura::contact
