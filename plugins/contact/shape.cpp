#include "shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sutura::contact {
namespace {

/// From a core (a point, a line) at `offset`, with a skin of this radius around it.
ShapeDistance around(const Vec3& offset, Real radius) {
  const Real length = offset.norm();
  if (!(length > 0)) return {-radius, Vec3::UnitX()};
  return {length - radius, offset / length};
}

/// Rounded edges: a smaller box with a skin.
ShapeDistance box(const Vec3& p, const Vec3& half_size, Real rounding) {
  const Vec3 half = half_size.array() - rounding;
  const Vec3 beyond = p.cwiseAbs() - half;
  const Vec3 sign = p.unaryExpr([](Real x) { return x < 0 ? Real(-1) : Real(1); });
  int face = 0;
  const Real deepest = beyond.maxCoeff(&face);
  if (deepest <= 0) return {deepest - rounding, sign[face] * Vec3::Unit(face)};
  const Vec3 out = beyond.cwiseMax(0);
  const Real distance = out.norm();
  return {distance - rounding, sign.cwiseProduct(out) / distance};
}

ShapeDistance cylinder(const Vec3& p, Real radius, Real half_length) {
  const Vec3 across(p.x(), p.y(), 0);
  const Real r = across.norm();
  const Vec3 outward = r > 0 ? Vec3(across / r) : Vec3::UnitX();
  const Vec3 along = p.z() < 0 ? Vec3(-Vec3::UnitZ()) : Vec3::UnitZ();
  const Real side = r - radius, cap = std::abs(p.z()) - half_length;
  if (side <= 0 || cap <= 0)
    return side > cap ? ShapeDistance{side, outward} : ShapeDistance{cap, along};
  const Real distance = std::hypot(side, cap);
  return {distance, (side * outward + cap * along) / distance};
}

}  // namespace

ShapeDistance Shape::at(const Vec3& p) const {
  switch (kind) {
    case Kind::plane:
      return {p.z(), Vec3::UnitZ()};
    case Kind::sphere:
      return around(p, radius);
    case Kind::capsule:
      return around(p - std::clamp(p.z(), -half_length, half_length) * Vec3::UnitZ(), radius);
    case Kind::cylinder:
      return cylinder(p, radius, half_length);
    case Kind::box:
      return box(p, half_size, rounding);
  }
  return {};
}

Vec3 Shape::core(const Vec3& p, Real layer) const {
  switch (kind) {
    case Kind::plane:
      break;
    case Kind::sphere:
    case Kind::capsule:
      return std::clamp(p.z(), -half_length, half_length) * Vec3::UnitZ();
    case Kind::cylinder: {
      const Real r = std::hypot(p.x(), p.y()), most = radius - layer;
      const Real in = r > most ? most / r : 1, top = half_length - layer;
      return {in * p.x(), in * p.y(), std::clamp(p.z(), -top, top)};
    }
    case Kind::box: {
      const Vec3 most = half_size.array() - std::max(layer, rounding);
      const Vec3 inner = p.cwiseMax(-most).cwiseMin(most), out = p - inner;
      const Real skin = std::max(rounding - layer, Real(0)), height = out.norm();
      return height > skin ? Vec3(inner + skin / height * out) : p;
    }
  }
  return p;
}

Facet Shape::facing(const Vec3& p, Real layer) const {
  const Vec3 apart = p - core(p, layer);
  const Real length = apart.norm();
  if (kind == Kind::plane || is_round() || !(length > 0)) return facet(p);
  const Vec3 n = apart / length;
  const auto sign = [](Real x) { return x < 0 ? Real(-1) : Real(1); };
  Vec3 foot = p;
  if (kind == Kind::cylinder) {
    const Real across = std::hypot(p.x(), p.y());
    if (across > radius - layer) foot.head<2>() *= radius / across;
    if (std::abs(p.z()) > half_length - layer) foot.z() = sign(p.z()) * half_length;
    return {n, foot};
  }
  for (int k = 0; k < 3; ++k)
    if (std::abs(p[k]) > half_size[k] - std::max(layer, rounding))
      foot[k] = sign(p[k]) * (half_size[k] - rounding);
  return {n, foot + rounding * n};
}

Real Shape::half_thickness() const {
  switch (kind) {
    case Kind::plane:
      break;
    case Kind::sphere:
    case Kind::capsule:
      return radius;
    case Kind::cylinder:
      return std::min(radius, half_length);
    case Kind::box:
      return half_size.minCoeff();
  }
  return std::numeric_limits<Real>::infinity();
}

std::vector<Vec3> Shape::wireframe() const {
  std::vector<Vec3> lines;
  const auto line = [&](const Vec3& a, const Vec3& b) { lines.push_back(a), lines.push_back(b); };
  constexpr int parts = 24;
  const auto circle = [&](const Vec3& centre, const Vec3& x, const Vec3& y) {
    const auto at = [&](int i) {
      const Real angle = 2 * std::numbers::pi * i / parts;
      return Vec3(centre + std::cos(angle) * x + std::sin(angle) * y);
    };
    for (int i = 0; i < parts; ++i) line(at(i), at(i + 1));
  };
  const Vec3 x = radius * Vec3::UnitX(), y = radius * Vec3::UnitY(), z = radius * Vec3::UnitZ();
  const Vec3 top = half_length * Vec3::UnitZ();
  const bool round_ends = kind == Kind::sphere || kind == Kind::capsule;
  switch (kind) {
    case Kind::plane: {
      constexpr Real shown = 0.05;  // m: a plane has no end
      for (int i = -2; i <= 2; ++i) {
        const Real at = shown * i / 2;
        line(Vec3(at, -shown, 0), Vec3(at, shown, 0));
        line(Vec3(-shown, at, 0), Vec3(shown, at, 0));
      }
      break;
    }
    case Kind::sphere:
    case Kind::capsule:
    case Kind::cylinder:
      for (const Vec3& end : {top, Vec3(-top)}) {
        circle(end, x, y);
        if (round_ends) circle(end, x, z), circle(end, y, z);
      }
      for (const Vec3& side : {x, Vec3(-x), y, Vec3(-y)}) line(side - top, side + top);
      break;
    case Kind::box:
      for (int corner = 0; corner < 8; ++corner)
        for (int axis = 0; axis < 3; ++axis) {
          if ((corner >> axis) & 1) continue;
          const auto place = [&](int c) {
            return Vec3(((c & 1) ? 1 : -1) * half_size.x(), ((c & 2) ? 1 : -1) * half_size.y(),
                        ((c & 4) ? 1 : -1) * half_size.z());
          };
          line(place(corner), place(corner | (1 << axis)));
        }
      break;
  }
  return lines;
}

}  // namespace sutura::contact
