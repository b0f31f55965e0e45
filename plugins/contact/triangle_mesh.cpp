#include "triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace sutura::contact {
namespace {

/// The number of each point among those at different places, in the order of their coordinates.
std::vector<Index> welded(const std::vector<Vec3>& points, std::vector<Vec3>& places) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t i) {
    return std::tuple(points[i].x(), points[i].y(), points[i].z(), i);
  };
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return key(a) < key(b); });
  std::vector<Index> number(points.size());
  for (const std::size_t i : order) {
    if (places.empty() || places.back() != points[i]) places.push_back(points[i]);
    number[i] = static_cast<Index>(places.size()) - 1;
  }
  return number;
}

std::string at(const Vec3& p) {
  const auto text = [](Real x) {
    std::string s = std::to_string(x);
    return s.substr(0, s.find('.') + 5);
  };
  return "at " + text(p.x()) + ' ' + text(p.y()) + ' ' + text(p.z());
}

}  // namespace

std::optional<TriangleMesh> TriangleMesh::close(const TriangleData& data, std::string& error) {
  TriangleMesh mesh;
  const std::vector<Index> number = welded(data.points, mesh.points_);
  Real volume = 0;
  for (const auto& t : data.triangles) {
    std::array<Index, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = number[static_cast<std::size_t>(t[k])];
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    mesh.triangles_.push_back(corners);
    const Corners c = mesh.corners(static_cast<Index>(mesh.triangles_.size()) - 1);
    volume += (c[0] - mesh.points_[0]).dot((c[1] - mesh.points_[0]).cross(c[2] - mesh.points_[0]));
  }
  if (mesh.triangles_.empty()) {
    error = "it has no triangles";
    return {};
  }
  if (volume < 0)
    for (auto& t : mesh.triangles_) std::swap(t[1], t[2]);
  error = mesh.find_edges();
  if (!error.empty()) return {};
  mesh.learn_normals();
  std::vector<Vec3> centres;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles_.size()); ++t) {
    const Corners c = mesh.corners(t);
    centres.push_back((c[0] + c[1] + c[2]) / 3);
  }
  mesh.tree_.emplace(centres);
  mesh.tree_->refit(mesh.boxes_, [&](Index t) {
    Box box;
    for (const Vec3& p : mesh.corners(t)) box.add(p);
    return box;
  });
  return mesh;
}

Corners TriangleMesh::corners(Index triangle) const {
  const auto& t = triangles_[static_cast<std::size_t>(triangle)];
  const auto point = [&](Index i) { return points_[static_cast<std::size_t>(i)]; };
  return {point(t[0]), point(t[1]), point(t[2])};
}

/// Of a closed surface every edge has two triangles, which run along it in opposite directions.
std::string TriangleMesh::find_edges() {
  struct Edge {
    Index low, high;
    bool up;
    std::size_t triangle, side;
  };
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b, t, k});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  beside_.resize(triangles_.size());
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high)
      ++end;
    const std::string where = ' ' + at((points_[static_cast<std::size_t>(edges[i].low)] +
                                        points_[static_cast<std::size_t>(edges[i].high)]) /
                                       2);
    if (end != i + 2)
      return "the surface is not closed: an edge" + where + " has " + std::to_string(end - i) +
             (end == i + 1 ? " triangle" : " triangles") + ", expected 2";
    if (edges[i].up == edges[i + 1].up)
      return "two triangles beside an edge" + where + " face different sides";
    beside_[edges[i].triangle][edges[i].side] = static_cast<Index>(edges[i + 1].triangle);
    beside_[edges[i + 1].triangle][edges[i + 1].side] = static_cast<Index>(edges[i].triangle);
    i = end;
  }
  return {};
}

void TriangleMesh::learn_normals() {
  point_normals_.assign(points_.size(), Vec3::Zero());
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Corners c = corners(static_cast<Index>(t));
    const Vec3 normal = (c[1] - c[0]).cross(c[2] - c[0]).stableNormalized();
    face_normals_.push_back(normal);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 u = c[(k + 1) % 3] - c[k], v = c[(k + 2) % 3] - c[k];
      point_normals_[static_cast<std::size_t>(triangles_[t][k])] +=
          std::atan2(u.cross(v).norm(), u.dot(v)) * normal;
    }
  }
}

Real TriangleMesh::signed_distance(const Vec3& p) const {
  Real least = std::numeric_limits<Real>::infinity(), sign = 1;
  Index nearest = -1;
  tree_->visit(
      boxes_, [&](const Box& box) { return box.squared_distance(p) <= least; },
      [&](Index t) {
        const Corners c = corners(t);
        const TrianglePoint foot = closest_point(p, c);
        const Vec3 apart = p - foot.on(c);
        const Real distance = apart.squaredNorm();
        if (distance > least || (distance == least && t > nearest)) return;
        least = distance;
        nearest = t;
        const auto i = static_cast<std::size_t>(t);
        Vec3 normal = face_normals_[i];
        if (foot.corner >= 0)
          normal = point_normals_[static_cast<std::size_t>(
              triangles_[i][static_cast<std::size_t>(foot.corner)])];
        else if (foot.edge >= 0)
          normal += face_normals_[static_cast<std::size_t>(
              beside_[i][static_cast<std::size_t>(foot.edge)])];
        sign = normal.dot(apart) < 0 ? -1 : 1;
      });
  return sign * std::sqrt(least);
}

}  // namespace sutura::contact
