#include "mesh_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "sutura/geometry/box_tree.h"
#include "sutura/geometry/distances.h"

namespace sutura::tissue {
namespace {

constexpr Real sliver_quality = 0.05;
// Quality is a ratio of a sum of products of about 20 roundings: below this a tet is flat.
constexpr Real flat_quality = 1e-9;

std::string number(Real x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}
std::string plural(Index n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

Real signed_quality(const MeshData& mesh, const Tet& t) {
  Real squares = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j)
      squares += (mesh.points[t[i]] - mesh.points[t[j]]).squaredNorm();
  if (squares == 0) return 0;
  const Real rms = std::sqrt(squares / 6);
  const auto& p = mesh.points;
  return std::sqrt(2.0) * six_volume(p[t[0]], p[t[1]], p[t[2]], p[t[3]]) / (rms * rms * rms);
}

std::string orient_tets(MeshData& mesh, MeshReport& report) {
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    Tet& t = mesh.tets[e];
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        if (t[i] == t[j])
          return "tetrahedron " + std::to_string(e) + " names node " + std::to_string(t[i]) +
                 " twice";
    Real quality = signed_quality(mesh, t);
    if (quality < 0) {
      std::swap(t[2], t[3]);
      ++report.reoriented;
      quality = -quality;
    }
    if (!(quality > flat_quality))
      return "tetrahedron " + std::to_string(e) + " has no volume (quality " + number(quality) +
             ")";
    if (quality < sliver_quality) ++report.slivers;
    if (quality < report.worst_quality || report.worst_tet < 0) {
      report.worst_quality = quality;
      report.worst_tet = static_cast<Index>(e);
    }
  }
  return {};
}

void remove_unused_nodes(MeshData& mesh, MeshReport& report) {
  std::vector<Index> renumbered(mesh.points.size(), -1);
  for (const Tet& t : mesh.tets)
    for (const Index i : t) renumbered[i] = 0;
  Index kept = 0;
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (renumbered[i] == 0) {
      renumbered[i] = kept;
      mesh.points[kept++] = mesh.points[i];
    }
  report.unused_nodes = static_cast<Index>(mesh.points.size()) - kept;
  mesh.points.resize(static_cast<std::size_t>(kept));
  for (Tet& t : mesh.tets)
    for (Index& i : t) i = renumbered[i];
}

void count_duplicates(const MeshData& mesh, MeshReport& report) {
  std::vector<Index> order(mesh.points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](Index i) {
    const Vec3& p = mesh.points[i];
    return std::array<Real, 3>{p.x(), p.y(), p.z()};
  };
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return key(a) < key(b); });
  report.duplicate_nodes = -mesh.copied_nodes;
  for (std::size_t k = 1; k < order.size(); ++k)
    if (key(order[k]) == key(order[k - 1])) ++report.duplicate_nodes;
}

void count_parts(const MeshData& mesh, MeshReport& report) {
  const std::vector<Index> first = first_of_part(mesh);
  for (std::size_t i = 0; i < first.size(); ++i)
    if (first[i] == static_cast<Index>(i)) ++report.parts;
}

/// Nodes of the boundary within a triangle of it whose corner they are not: one side of a surface
/// is divided otherwise than the other.
void count_hanging_nodes(const MeshData& mesh, const std::vector<BoundaryFace>& boundary,
                         MeshReport& report) {
  constexpr Real rounding = 1e-9;  // of the size of the mesh
  const Real near = rounding * (report.high - report.low).norm();
  const auto corners = [&](Index face) {
    const Triangle& t = boundary[static_cast<std::size_t>(face)].nodes;
    return Corners{mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
  };
  std::vector<Vec3> centres;
  std::vector<Index> nodes;
  for (std::size_t i = 0; i < boundary.size(); ++i) {
    const Corners c = corners(static_cast<Index>(i));
    centres.push_back((c[0] + c[1] + c[2]) / 3);
    for (const Index n : boundary[i].nodes) nodes.push_back(n);
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  const BoxTree tree(centres);
  BoxTree::Boxes boxes;
  tree.refit(boxes, [&](Index face) {
    Box box;
    for (const Vec3& p : corners(face)) box.add(p);
    return box.grown(near);
  });
  for (const Index n : nodes) {
    const Vec3& p = mesh.points[n];
    bool hangs = false;
    tree.visit(
        boxes, [&](const Box& box) { return !hangs && box.squared_distance(p) == 0; },
        [&](Index face) {
          const Corners c = corners(face);
          const auto is_at = [&](const Vec3& corner) { return (corner - p).norm() <= near; };
          if (std::none_of(c.begin(), c.end(), is_at))
            hangs = hangs || (closest_point(p, c).on(c) - p).norm() <= near;
        });
    if (hangs) ++report.hanging_nodes;
  }
}

/// Each face belongs to one tet (boundary) or to two that lie on opposite sides of it.
std::string find_boundary(const MeshData& mesh, std::vector<BoundaryFace>& boundary) {
  struct Face {
    Triangle sorted, outward;
    Index tet;
    Index opposite;
  };
  static constexpr int local[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};  // outward
  std::vector<Face> faces;
  faces.reserve(4 * mesh.tets.size());
  for (std::size_t e = 0; e < mesh.tets.size(); ++e)
    for (std::size_t k = 0; k < 4; ++k) {
      const Tet& t = mesh.tets[e];
      Face f{{}, {}, static_cast<Index>(e), t[k]};
      for (std::size_t c = 0; c < 3; ++c) f.outward[c] = t[local[k][c]];
      f.sorted = f.outward;
      std::sort(f.sorted.begin(), f.sorted.end());
      faces.push_back(f);
    }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.sorted != b.sorted ? a.sorted < b.sorted : a.tet < b.tet;
  });
  const auto side = [&](const Triangle& t, Index node) {
    const auto& p = mesh.points;
    return six_volume(p[t[0]], p[t[1]], p[t[2]], p[node]) > 0;
  };
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end].sorted == faces[i].sorted) ++end;
    const Face &a = faces[i], &b = faces[end - 1];
    if (end - i > 2)
      return "tetrahedra " + std::to_string(a.tet) + ", " + std::to_string(faces[i + 1].tet) +
             " and " + std::to_string(b.tet) + " share one face";
    if (end - i == 2 && side(a.sorted, a.opposite) == side(a.sorted, b.opposite))
      return "tetrahedra " + std::to_string(a.tet) + " and " + std::to_string(b.tet) +
             " lie on the same side of the face they share: one of them is inside out";
    if (end - i == 1) boundary.push_back({a.outward, a.tet});
    i = end;
  }
  std::sort(boundary.begin(), boundary.end(), [](const BoundaryFace& a, const BoundaryFace& b) {
    return a.tet != b.tet ? a.tet < b.tet : a.nodes < b.nodes;
  });
  return {};
}

void write_warnings(MeshReport& r, Index tets, bool assumed_metres) {
  auto& w = r.warnings;
  if (r.reoriented > 0 && r.reoriented < tets)
    w.push_back(std::to_string(r.reoriented) + " of " + std::to_string(tets) +
                " tetrahedra listed their nodes in the opposite sense and were reordered");
  if (r.unused_nodes > 0)
    w.push_back(plural(r.unused_nodes, "node", "nodes") + " used by no tetrahedron removed");
  if (r.duplicate_nodes > 0)
    w.push_back(plural(r.duplicate_nodes, "node lies", "nodes lie") +
                " exactly on another one: the mesh is not joined there");
  if (r.hanging_nodes > 0)
    w.push_back(plural(r.hanging_nodes, "node lies", "nodes lie") +
                " within the face of a tetrahedron without being a corner of it: the mesh is not "
                "joined there");
  if (r.parts > 1)
    w.push_back("the mesh has " + std::to_string(r.parts) + " parts that are not connected");
  if (r.slivers > 0)
    w.push_back(plural(r.slivers, "sliver", "slivers") + " (quality below " +
                number(sliver_quality) + "; the worst, tetrahedron " + std::to_string(r.worst_tet) +
                ", has " + number(r.worst_quality) + ")");
  const Real size = (r.high - r.low).norm();
  if (assumed_metres && size > 2)
    w.push_back("the mesh is " + number(size) +
                " m across; if its numbers are millimetres, set unit=\"mm\"");
}

}  // namespace

std::vector<Index> first_of_part(const MeshData& mesh) {
  std::vector<Index> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const Tet& t : mesh.tets)
    for (std::size_t k = 1; k < 4; ++k) {
      const Index a = root(t[0]), b = root(t[k]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = root(static_cast<Index>(i));
  return parent;
}

CheckedMesh check_mesh(MeshData& mesh, bool assumed_metres) {
  CheckedMesh out;
  MeshReport& report = out.report;
  out.error = orient_tets(mesh, report);
  if (!out.error.empty()) return out;
  remove_unused_nodes(mesh, report);
  count_duplicates(mesh, report);
  count_parts(mesh, report);
  out.error = find_boundary(mesh, out.boundary);
  report.low = report.high = mesh.points.front();
  for (const Vec3& p : mesh.points) {
    report.low = report.low.cwiseMin(p);
    report.high = report.high.cwiseMax(p);
  }
  if (out.error.empty()) count_hanging_nodes(mesh, out.boundary, report);
  write_warnings(report, static_cast<Index>(mesh.tets.size()), assumed_metres);
  return out;
}

}  // namespace sutura::tissue
