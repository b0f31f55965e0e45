// Touches of two surfaces, or of one with itself: nodes of each against triangles of the other that
// face them, and edges that stand out against each other.
#pragma once

#include <optional>

#include "bulge.h"
#include "edges_through.h"
#include "held_triangles.h"
#include "near_triangles.h"
#include "surface_edges.h"
#include "touch.h"

namespace sutura::contact {

class SurfaceSurface : public Pair {
 public:
  using Side = std::shared_ptr<const Boundary>;
  /// The first is that of a solid.
  SurfaceSurface(const Side& first, const Side& second)
      : first_(first), second_(second), is_self_(first == second) {}
  Real built_from(const Touch& touch) const override;
  Vec3 slip(const Touch& touch) const override;
  void couple(const Touch& touch, BlockId block, const Directions& axes,
              ConstraintBuilder& builder) const override;
  void tell_force(const Touch& touch, const Vec3& force) override {
    second().boundary()->tell_force(-force, touch.at);
  }
  Real unseen_overlap() override;
  Real distance() const override;
  Tolerance tolerance(const Touch& touch) const override;

 protected:
  void look_for_touches(const TouchedPlaces& before, std::vector<Touch>& out) override;

 private:
  const MovingSurface& second() const { return is_self_ ? first_ : second_; }
  /// The node of a touch is one of the first, its triangle one of the second; or the other way
  /// round.
  const MovingSurface& nodes_of(const Touch& t) const {
    return t.nodes_are_second ? second() : first_;
  }
  const MovingSurface& faces_of(const Touch& t) const {
    return t.nodes_are_second ? first_ : second();
  }
  /// In units of length: how far a touch reaches.
  Real edge_length() const;
  /// So deep behind a triangle something is taken for having come in there (m).
  Real deepest(const MovingSurface& faces, Index triangle) const;
  /// Both; `standing`: without their ways.
  void look(bool standing);
  /// Nodes of one surface that look for triangles of the other.
  struct Search {
    const MovingSurface& nodes;
    const MovingSurface& faces;
    const SurfaceNormals& node_normals;
    const SurfaceNormals& face_normals;
    const NearTriangles& near;
    const TouchedPlaces& before;
    bool nodes_are_second;
    Real reach;   ///< in front of a triangle (m)
    Real around;  ///< m
  };
  struct Seeker {
    Vec3 at, outward;
    std::optional<bool> is_inside;  ///< the body of the triangles, as far as that was asked
  };
  void meet(bool nodes_are_second, Real reach, const TouchedPlaces& before,
            std::vector<Touch>& out);
  void meet_node(const Search& search, std::size_t place, std::vector<Touch>& out);
  /// Of a touch, on the first partner; those of nodes of the second are below 0.
  static Real place_of(const Search& search, Index node);
  bool is_said_already(const Search& search, Index node, Index triangle, Real height) const;
  static bool ends_a_cut(const Search& search, const MovingSurface::SurfaceNode& n);
  static Real turned_away(const Search& search, const MovingSurface::SurfaceNode& n,
                          const Vec3& outward);
  static bool faces_a_side(const Search& search, const MovingSurface::SurfaceNode& n,
                           const Vec3& normal);
  /// Where on its way a node goes through a triangle, deeper than touches see: until when it is
  /// free, and where on the triangle; 1 if it does not.
  struct Passing {
    Real free = 1;
    Vec3 weights = Vec3::Zero();
  };
  Passing passing(const MovingSurface& nodes, Index node, const MovingSurface& faces,
                  Index triangle) const;
  /// Edges of the first against edges of the second.
  void meet_edges(Real reach, std::vector<Touch>& out);
  void meet_edges(Index i, Index j, Real reach, std::vector<Touch>& out);
  /// An edge that stands out, as the step begins or now.
  struct Ridge {
    Index edge;
    bool is_second;
    Box way;  ///< that of the first reaches as far as a touch does
  };
  void add_ridges(bool of_second, Real reach);
  void find_near_ridges();
  void doubt();
  void drop_doubles(std::vector<Touch>& out);
  static Real smallest_distance(const MovingSurface& nodes, const MovingSurface& faces);

  /// A triangle that a node may touch.
  struct Near {
    Index triangle = -1;
    Vec3 weights = Vec3::Zero();
    Real distance = 0;  ///< m
  };
  /// To those of the node, if this one is.
  void add_near(const Search& search, Index node, Index triangle, Seeker& seeker);
  Near nearest() const;
  bool make_valley(const Search& search, Index one, Index other) const;
  static void touch(const Search& search, const MovingSurface::SurfaceNode& node, const Vec3& at,
                    const Near& on, std::vector<Touch>& out);
  std::vector<Near> near_;  ///< of the node that is looked at
  MovingSurface first_, second_;
  ToolWay way_;  ///< of the second, if it is a tool
  bool is_self_;
  SurfaceNormals normals_first_, normals_second_;
  NearTriangles near_first_, near_second_;  ///< of the nodes of this one
  EdgesThrough through_first_, through_second_;
  SurfaceEdges edges_first_, edges_second_;
  std::vector<Ridge> ridges_;
  std::vector<std::pair<Index, Index>> near_ridges_;  ///< ascending
  const SurfaceEdges& edges_of_second() const { return is_self_ ? edges_first_ : edges_second_; }
  HeldTriangles held_;
  std::vector<Index> met_;  ///< by node of the first: the node of the second that it meets, or -1
};

}  // namespace sutura::contact
