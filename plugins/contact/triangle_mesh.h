// A closed surface of triangles, as an instrument has it, and how far a point is from it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "sutura/geometry/box_tree.h"
#include "sutura/geometry/distances.h"

namespace sutura::contact {

struct TriangleData {
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> triangles;
};

class TriangleMesh {
 public:
  /// Points at the same place become one; a surface that is inside out is turned. Nothing, and a
  /// sentence, if it is not closed: only a closed one has an inside.
  static std::optional<TriangleMesh> close(const TriangleData& data, std::string& error);

  const std::vector<Vec3>& points() const { return points_; }
  const std::vector<std::array<Index, 3>>& triangles() const { return triangles_; }
  /// Negative inside (m). The sign comes from the angle-weighted normal of the nearest corner, edge
  /// or face (Baerentzen and Aanaes 2005, "Signed distance computation using the angle weighted
  /// pseudonormal").
  Real signed_distance(const Vec3& p) const;

 private:
  Corners corners(Index triangle) const;
  std::string find_edges();
  void learn_normals();

  std::vector<Vec3> points_;
  std::vector<std::array<Index, 3>> triangles_;
  std::vector<std::array<Index, 3>> beside_;  ///< the triangles across edges 01, 12, 20
  std::vector<Vec3> face_normals_, point_normals_;
  std::optional<BoxTree> tree_;
  BoxTree::Boxes boxes_;
};

}  // namespace sutura::contact
