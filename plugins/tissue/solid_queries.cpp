#include "solid_queries.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "sutura/geometry/distances.h"

namespace sutura::tissue {
namespace {

template <class Items>
std::vector<Vec3> centres(const std::vector<Vec3>& x, const Items& items) {
  std::vector<Vec3> out;
  out.reserve(items.size());
  for (const auto& item : items) {
    Vec3 sum = Vec3::Zero();
    for (const Index i : item) sum += x[i];
    out.push_back(sum / static_cast<Real>(item.size()));
  }
  return out;
}
std::vector<Triangle> triangles(const std::vector<BoundaryFace>& boundary) {
  std::vector<Triangle> out;
  for (const BoundaryFace& f : boundary) out.push_back(f.nodes);
  return out;
}
Vec3 unit(const Vec3& v) {
  const Real length = v.norm();
  return length > 0 ? Vec3(v / length) : Vec3::Zero();
}
Real angle_at(const Vec3& corner, const Vec3& a, const Vec3& b) {
  const Vec3 u = a - corner, v = b - corner;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// Points seen along a segment: x and y across it, z its parameter (0 at a, 1 at b). A point is
/// rounded once, whatever triangle it is seen in, and `side` rounds monotonically: its sign is
/// right or it is zero. So no segment finds a gap between triangles (Woop, Benthin and Wald, 2013).
class AlongSegment {
 public:
  AlongSegment(const Vec3& a, const Vec3& b) : a_(a), d_(b - a) {
    d_.cwiseAbs().maxCoeff(&k_);
    i_ = (k_ + 1) % 3;
    j_ = (k_ + 2) % 3;
  }
  bool empty() const { return d_[k_] == 0; }
  Vec3 operator()(const Vec3& p) const {
    const Vec3 q = p - a_;
    const Real z = q[k_] / d_[k_];
    return {q[i_] - z * d_[i_], q[j_] - z * d_[j_], z};
  }
  static Real side(const Vec3& p, const Vec3& q) { return p[0] * q[1] - q[0] * p[1]; }

 private:
  Vec3 a_, d_;
  int i_ = 0, j_ = 0, k_ = 0;
};

}  // namespace

SolidTopology::SolidTopology(const std::vector<Vec3>& rest, std::vector<Tet> tets,
                             const std::vector<BoundaryFace>& boundary)
    : tets_(std::move(tets)),
      triangles_(triangles(boundary)),
      tet_tree_(centres(rest, tets_)),
      triangle_tree_(centres(rest, triangles_)) {
  for (const BoundaryFace& f : boundary) tet_behind_.push_back(f.tet);
  std::map<std::array<Index, 2>, Index> number;
  for (const Triangle& t : triangles_) {
    std::array<Index, 3> edges{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Index i = t[k], j = t[(k + 1) % 3];
      edges[k] =
          number.try_emplace({std::min(i, j), std::max(i, j)}, static_cast<Index>(number.size()))
              .first->second;
    }
    edge_of_.push_back(edges);
  }
  edges_ = static_cast<Index>(number.size());
}

EmbeddedPoint SolidTopology::on_surface(Index triangle, const Vec3& weights) const {
  const Triangle& corners = triangles_[triangle];
  EmbeddedPoint p{.element = tet_behind_[triangle], .weights = {}};
  const Tet& tet = tets_[p.element];
  for (std::size_t k = 0; k < 3; ++k) {
    const auto place = std::find(tet.begin(), tet.end(), corners[k]) - tet.begin();
    p.weights[static_cast<std::size_t>(place)] = weights[static_cast<Index>(k)];
  }
  return p;
}

std::array<Vec3, 3> SolidQueries::corners(Index triangle) const {
  const Triangle& t = topology_->triangles_[triangle];
  return {point(t[0]), point(t[1]), point(t[2])};
}

Vec3 SolidQueries::position(const EmbeddedPoint& p) const {
  const Tet& t = topology_->tets_[p.element];
  Vec3 x = Vec3::Zero();
  for (std::size_t k = 0; k < 4; ++k) x += p.weights[k] * point(t[k]);
  return x;
}

Vec3 SolidQueries::surface_normal(Index triangle) const {
  const std::array<Vec3, 3> t = corners(triangle);
  return unit((t[1] - t[0]).cross(t[2] - t[0]));
}

void SolidQueries::fit_tets() const {
  if (tets_fitted_) return;
  topology_->tet_tree_.refit(tet_boxes_, [&](Index e) {
    Box box;
    for (const Index i : topology_->tets_[e]) box.add(point(i));
    return box;
  });
  tets_fitted_ = true;
}

void SolidQueries::fit_triangles() const {
  if (triangles_fitted_) return;
  topology_->triangle_tree_.refit(triangle_boxes_, [&](Index f) {
    Box box;
    for (const Vec3& p : corners(f)) box.add(p);
    return box;
  });
  triangles_fitted_ = true;
}

void SolidQueries::find_normals() const {
  if (normals_found_) return;
  vertex_normal_.assign(static_cast<std::size_t>(x_->size() / 3), Vec3::Zero());
  edge_normal_.assign(static_cast<std::size_t>(topology_->edges_), Vec3::Zero());
  for (Index f = 0; f < static_cast<Index>(topology_->triangles_.size()); ++f) {
    const std::array<Vec3, 3> t = corners(f);
    const Vec3 normal = unit((t[1] - t[0]).cross(t[2] - t[0]));
    for (std::size_t k = 0; k < 3; ++k) {
      vertex_normal_[topology_->triangles_[f][k]] +=
          angle_at(t[k], t[(k + 1) % 3], t[(k + 2) % 3]) * normal;
      edge_normal_[topology_->edge_of_[f][k]] += normal;
    }
  }
  normals_found_ = true;
}

SurfacePoint SolidQueries::on_triangle(Index triangle, const Vec3& weights) const {
  SurfacePoint s;
  s.triangle = triangle;
  s.at = topology_->on_surface(triangle, weights);
  const std::array<Vec3, 3> t = corners(triangle);
  for (std::size_t k = 0; k < 3; ++k) s.position += weights[static_cast<Index>(k)] * t[k];
  s.normal = surface_normal(triangle);
  return s;
}

std::optional<EmbeddedPoint> SolidQueries::locate(const Vec3& p) const {
  fit_tets();
  // Of all tets that hold the point (or miss it by rounding), the one that holds it deepest.
  constexpr Real rounding = 1e-10;
  Real deepest = -rounding;
  std::optional<EmbeddedPoint> best;
  const Real size = tet_boxes_.empty() ? 0 : (tet_boxes_[0].high - tet_boxes_[0].low).norm();
  const Real margin = rounding * size;
  topology_->tet_tree_.visit(
      tet_boxes_, [&](const Box& box) { return box.squared_distance(p) <= margin * margin; },
      [&](Index e) {
        const Tet& t = topology_->tets_[e];
        const Vec3 a = point(t[0]), b = point(t[1]), c = point(t[2]), d = point(t[3]);
        const Real whole = six_volume(a, b, c, d);
        if (!(whole > 0)) return;  // flat or inverted: holds nothing
        std::array<Real, 4> w{0, six_volume(a, p, c, d) / whole, six_volume(a, b, p, d) / whole,
                              six_volume(a, b, c, p) / whole};
        w[0] = 1 - w[1] - w[2] - w[3];
        const Real depth = *std::min_element(w.begin(), w.end());
        if (depth > deepest || (best && depth == deepest && e < best->element)) {
          deepest = depth;
          best = EmbeddedPoint{e, w};
        }
      });
  return best;
}

/// Is p within an element that has not this corner, or on the border of one?
bool SolidQueries::is_in_others(Index corner, const Vec3& p) const {
  constexpr Real rounding = 1e-9;
  bool found = false;
  topology_->tet_tree_.visit(
      tet_boxes_, [&](const Box& box) { return !found && box.squared_distance(p) == 0; },
      [&](Index e) {
        const Tet& t = topology_->tets_[e];
        if (found || std::find(t.begin(), t.end(), corner) != t.end()) return;
        const Vec3 a = point(t[0]), b = point(t[1]), c = point(t[2]), d = point(t[3]);
        const Real least = -rounding * six_volume(a, b, c, d);
        found = six_volume(p, b, c, d) >= least && six_volume(a, p, c, d) >= least &&
                six_volume(a, b, p, d) >= least && six_volume(a, b, c, p) >= least;
      });
  return found;
}

std::optional<SurfacePoint> SolidQueries::deepest_in_itself(Real slack) const {
  fit_tets();
  find_normals();
  // Of a flat place 2 pi. Zero where a node is not of the boundary, and, but for rounding, where a
  // closed cut ends, as its walls look opposite ways.
  constexpr Real least = 0.1;
  std::optional<SurfacePoint> deepest;
  for (Index i = 0; i < static_cast<Index>(vertex_normal_.size()); ++i) {
    if (vertex_normal_[i].norm() < least) continue;
    const Vec3 outward = unit(vertex_normal_[i]);
    if (!is_in_others(i, point(i) + slack * outward)) continue;
    const auto behind = closest_surface(point(i), std::numeric_limits<Real>::max(), -outward);
    if (!behind || !(behind->distance < 0)) continue;
    if (!deepest || behind->distance < deepest->distance) deepest = behind;
  }
  return deepest;
}

/// Of no direction (zero), true for every triangle.
bool SolidQueries::faces(Index triangle, const Vec3& direction) const {
  return direction.isZero(0) || surface_normal(triangle).dot(direction) > 0;
}

std::optional<SurfacePoint> SolidQueries::closest_surface(const Vec3& p, Real reach,
                                                          const Vec3& facing) const {
  fit_triangles();
  // The triangles at an edge are as far from what is beside it, up to rounding, and it must not
  // decide between the top of a block and its side: the one that faces that way more is taken, and
  // of two that are as flat the lower number.
  const bool any_way = facing.isZero(0);
  const Real rounding = any_way ? 0 : 1e4 * std::numeric_limits<Real>::epsilon() * p.norm();
  const Real as_flat = 1e-6 * facing.norm();
  Real least = reach * reach, turned = 0;
  const auto tie = [&] { return rounding * (2 * std::sqrt(least) + rounding); };
  Index triangle = -1;
  TrianglePoint closest;
  topology_->triangle_tree_.visit(
      triangle_boxes_, [&](const Box& box) { return box.squared_distance(p) <= least + tie(); },
      [&](Index f) {
        if (!faces(f, facing)) return;
        const std::array<Vec3, 3> t = corners(f);
        const TrianglePoint c = closest_point(p, t);
        const Real distance = (p - c.on(t)).squaredNorm();
        const Real towards = any_way ? 0 : surface_normal(f).dot(facing);
        if (distance > least + tie()) return;
        if (triangle >= 0 && distance >= least - tie()) {
          if (towards < turned - as_flat) return;
          if (towards <= turned + as_flat && f > triangle) return;
        }
        least = std::min(least, distance);
        turned = towards;
        triangle = f;
        closest = c;
      });
  if (triangle < 0) return {};
  SurfacePoint s = on_triangle(triangle, closest.weights);
  if (closest.corner >= 0 || closest.edge >= 0) find_normals();
  if (closest.corner >= 0)
    s.normal = unit(vertex_normal_[topology_->triangles_[triangle][closest.corner]]);
  else if (closest.edge >= 0)
    s.normal = unit(edge_normal_[topology_->edge_of_[triangle][closest.edge]]);
  const Vec3 r = p - s.position;
  s.distance = std::copysign(r.norm(), r.dot(s.normal));
  return s;
}

std::optional<SurfacePoint> SolidQueries::crossing(const Vec3& a, const Vec3& b,
                                                   const Vec3& facing) const {
  fit_triangles();
  Real first = 2;
  Index triangle = -1;
  Vec3 weights = Vec3::Zero();
  const Real size =
      triangle_boxes_.empty() ? 0 : (triangle_boxes_[0].high - triangle_boxes_[0].low).norm();
  const Real margin = 1e-12 * (size + (b - a).norm());
  const AlongSegment along(a, b);
  if (along.empty()) return {};
  topology_->triangle_tree_.visit(
      triangle_boxes_, [&](const Box& box) { return box.meets_segment(a, b, margin); },
      [&](Index f) {
        std::array<Vec3, 3> t = corners(f);
        for (Vec3& p : t) p = along(p);
        const Vec3 w(along.side(t[1], t[2]), along.side(t[2], t[0]), along.side(t[0], t[1]));
        if (!((w.array() >= 0).all() || (w.array() <= 0).all())) return;
        const Real sum = w.sum();
        if (sum == 0) return;  // seen edge on
        const Real s = (w[0] * t[0][2] + w[1] * t[1][2] + w[2] * t[2][2]) / sum;
        if (!(s >= 0 && s <= 1) || s > first || (s == first && f > triangle)) return;
        if (!faces(f, facing)) return;
        first = s;
        triangle = f;
        weights = w / sum;
      });
  if (triangle < 0) return {};
  SurfacePoint s = on_triangle(triangle, weights);
  s.distance = (a - s.position).dot(s.normal);
  return s;
}

}  // namespace sutura::tissue
