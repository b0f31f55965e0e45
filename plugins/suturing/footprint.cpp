#include "footprint.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sutura/archive.h"

namespace sutura::suturing {
namespace {

constexpr Real pi = std::numbers::pi;
constexpr int most_points = 32;
constexpr Real bearable = 0.3;   // mean pressure on the disc, in units of E
constexpr Real too_much = 0.45;  // likewise: the widest disc is dented by 0.7 of its radius
constexpr Real widest = 10;      // disc, in units of the radius of the shaft
constexpr Real deepest = 3;      // dent of the near field, of the disc: linear theory says no more

constexpr Real most_stretch = 4;   // what is further apart now than that, of rest, is torn apart
constexpr Real search_reach = 2;   // by how far a point slides
constexpr Real half_turned = 0.5;  // cosine; a normal that turns by more shows another surface

/// A direction along the surface that belongs to the mesh and not to the axes of the world: the
/// edge of the tetrahedron under it that lies flattest.
Vec3 along_surface(const SolidBody& tissue, const SurfacePoint& surface, Configuration shape,
                   const Vec3& normal) {
  const auto corner = [&](std::size_t k) {
    EmbeddedPoint p{.element = surface.at.element};
    p.weights = {0, 0, 0, 0};
    p.weights[k] = 1;
    return tissue.position(p, shape);
  };
  Vec3 flattest = Vec3::Zero();
  for (std::size_t k = 1; k < 4; ++k) {
    const Vec3 edge = (corner(k) - corner(0)).normalized();
    const Vec3 flat = edge - edge.dot(normal) * normal;
    if (flat.squaredNorm() > flattest.squaredNorm()) flattest = flat;
  }
  return flattest.isZero(0) ? normal.unitOrthogonal() : flattest.normalized();
}

}  // namespace

void Footprint::archive(Archive& a) {
  a.list("points", points_, [](Archive& each, SurfacePoint& p) {
    each("at", p.at);
    each("triangle", p.triangle);
  });
  a("offset", offset_);
  a("disc", disc_);
  a("compliance", compliance_);
  a("bears", bears_);
}

Footprint::Footprint() {
  points_.reserve(most_points);
}

void Footprint::find(const SurfacePoint& surface) {
  points_.assign(1, surface);
  offset_.setZero();
  disc_ = compliance_ = 0;
  bears_ = std::numeric_limits<Real>::infinity();
}

/// The size of the disc, and what follows from it.
void Footprint::fit(const SolidBody& tissue, const SurfacePoint& surface, const Pressing& tip) {
  const Elasticity material = tissue.elasticity(surface.at);
  if (!(material.young > 0)) return;
  const Real borne = std::sqrt(tip.force / (bearable * pi * material.young));
  disc_ = std::clamp(borne, tip.shaft_radius, widest * tip.shaft_radius);
  bears_ = too_much * pi * disc_ * disc_ * material.young;
  compliance_ = 0;
  if (tip.tip_radius > 0) {
    const Real plane = (1 - material.poisson * material.poisson) / material.young;
    compliance_ = plane * std::max(1 / (2 * tip.tip_radius) - 16 / (3 * pi * pi * disc_), Real(0));
    compliance_ = std::min(compliance_, deepest * disc_ / tip.force);
  }
}

void Footprint::find(const SolidBody& tissue, const SurfacePoint& surface, const Pressing& tip,
                     Configuration shape) {
  find(surface);
  fit(tissue, surface, tip);
  if (disc_ == 0) return;

  // Points of equal area on the disc (a sunflower), each taken to the surface.
  points_.clear();
  const Vec3 centre = tissue.position(surface.at, shape);
  const Vec3 outward = tissue.surface_normal(surface.triangle, shape);
  const Vec3 normal = shape == Configuration::start ? surface.normal : outward;
  const Vec3 u = along_surface(tissue, surface, shape, normal), v = normal.cross(u);
  const Real golden = pi * (3 - std::sqrt(Real(5)));
  for (int k = 0; k < most_points; ++k) {
    const Real r = disc_ * std::sqrt((k + 0.5) / most_points), angle = golden * k;
    const Vec3 p = centre + r * (std::cos(angle) * u + std::sin(angle) * v);
    // The other side of a slit or of a thin sheet is not under the tip.
    const auto foot = tissue.closest_surface(p, disc_, shape, outward);
    if (!foot) continue;
    const Vec3 apart = tissue.position(foot->at, Configuration::start) - surface.position;
    if (apart.norm() < most_stretch * r) points_.push_back(*foot);
  }
  if (points_.empty()) points_.push_back(surface);
  Vec3 mean = Vec3::Zero();
  for (const SurfacePoint& p : points_)
    mean += tissue.position(p.at, Configuration::start) / static_cast<Real>(points_.size());
  offset_ = surface.position - mean;
}

void Footprint::slide(const SolidBody& tissue, const SurfacePoint& from, const SurfacePoint& to,
                      const Vec3& under, const Pressing& tip) {
  constexpr Configuration rest = Configuration::rest, start = Configuration::start;
  const Vec3 before = normal(tissue, start);
  const Real height = offset_.dot(before);
  const Real was = disc_;
  fit(tissue, to, tip);
  // In the shape at rest, where there is no tent, it moves like a rigid disc.
  const Real growth = was > 0 ? disc_ / was : 1;
  const Vec3 away = tissue.position(from.at, rest), there = tissue.position(to.at, rest);
  const Vec3 outward = tissue.surface_normal(to.triangle, rest);
  const Quat turn = shortest_rotation(tissue.surface_normal(from.triangle, rest), outward);
  const Real way = (there - away).norm() + std::abs(growth - 1) * was;
  for (SurfacePoint& p : points_) {
    const Vec3 goal = there + growth * (turn * (tissue.position(p.at, rest) - away));
    const auto foot = tissue.closest_surface(goal, search_reach * way, rest, outward);
    if (!foot) continue;
    // Over to the other lip of an open wound it does not go.
    const Vec3 went = tissue.position(foot->at, start) - tissue.position(p.at, start);
    if (went.norm() < most_stretch * way) p = *foot;
  }
  offset_.setZero();
  const Vec3 n = normal(tissue, start), gap = under - position(tissue, start);
  // Seen along the normal that it had: beside an edge the mean is a millimetre away from the tip,
  // and a normal that turns at once, as points pass from the top to the side, would lift the place
  // by a part of that.
  const Vec3 up = n.dot(before) > half_turned ? before : n;
  offset_ = gap + (height - gap.dot(up)) / n.dot(up) * n;
}

Vec3 Footprint::position(const SolidBody& tissue, Configuration c) const {
  Vec3 sum = Vec3::Zero();
  for (const SurfacePoint& p : points_) sum += tissue.position(p.at, c);
  return sum / static_cast<Real>(points_.size()) + offset_;
}

Vec3 Footprint::normal(const SolidBody& tissue, Configuration c) const {
  Vec3 sum = Vec3::Zero();
  for (const SurfacePoint& p : points_) sum += tissue.surface_normal(p.triangle, c);
  return sum.normalized();
}

void Footprint::couple(ConstraintBuilder& builder, BlockId block, const SolidBody& tissue,
                       const Mat3& directions, const Vec3& at) const {
  const Directions share = directions / static_cast<Real>(points_.size());
  PointJacobian J;
  for (const SurfacePoint& p : points_) {
    tissue.jacobian(p.at, J);
    builder.couple(block, tissue, share, J, at);
  }
}

}  // namespace sutura::suturing
